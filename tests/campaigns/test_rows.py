"""Rows on the disk: appended, read again, cut off in the middle."""

import csv
import json

import pytest

from tightspot.campaigns import RowFile
from tightspot.campaigns.rows import COLUMNS
from tightspot.errors import InputError

SETTINGS = {"settings": "recovered", "runs": 1}


def test_rows_come_back_as_they_were(tmp_path, make_row):
    file = RowFile(tmp_path / "rows.jsonl", SETTINGS)
    rows = [make_row(), make_row(guess="simplified", status="NO_GUESS", objective=None, verdict='says "no", | so')]
    for row in rows:
        file.append(row)
    assert list(RowFile(tmp_path / "rows.jsonl", SETTINGS).rows.values()) == rows


@pytest.mark.parametrize("cut", [1, 10, 200])
def test_a_line_that_was_cut_off_is_lost_and_no_other(tmp_path, make_row, cut):
    path = tmp_path / "rows.jsonl"
    file = RowFile(path, SETTINGS)
    first, second = make_row(), make_row(guess="simplified")
    file.append(first)
    file.append(second)
    path.write_bytes(path.read_bytes()[:-cut])
    again = RowFile(path, SETTINGS)
    assert list(again.rows) == [first.key]
    again.append(second)
    assert list(RowFile(path, SETTINGS).rows) == [first.key, second.key]


def test_rows_of_other_settings_are_refused(tmp_path, make_row):
    RowFile(tmp_path / "rows.jsonl", SETTINGS).append(make_row())
    with pytest.raises(InputError, match=r"other runs; choose another directory"):
        RowFile(tmp_path / "rows.jsonl", SETTINGS | {"runs": 5})


@pytest.mark.parametrize("content", ["", "hello\n", '{"a": 1}\n', '{"settings": {}}\n{"key": 1}\n'])
def test_another_file_is_refused_and_left_alone(tmp_path, content):
    path = tmp_path / "rows.jsonl"
    path.write_text(content)
    with pytest.raises(InputError, match="not a file of this campaign"):
        RowFile(path, SETTINGS)
    assert path.read_text() == content


def test_the_csv_has_all_rows_and_no_trajectories(tmp_path, make_row):
    file = RowFile(tmp_path / "rows.jsonl", SETTINGS)
    file.append(make_row(trajectory={"t": [0, 1]}, verdict="one, two"))
    file.write_csv(tmp_path / "rows.csv")
    with (tmp_path / "rows.csv").open() as lines:
        (row,) = csv.DictReader(lines)
    assert tuple(row) == COLUMNS
    assert "trajectory" not in row
    assert (row["verdict"], float(row["objective"])) == ("one, two", 1.0)
    assert json.loads((tmp_path / "rows.jsonl").read_text().splitlines()[1])["trajectory"] == {"t": [0, 1]}
