"""Tables of every kind are read; what is wrong with one is told line by line."""

from __future__ import annotations

import numpy as np
import pytest
from tests.verification.tables.honest import drive, text

from tightspot.errors import InputError, TableError
from tightspot.vehicles import vehicle
from tightspot.verification import Table, load_plan, read_table, write_trajectory_csv
from tightspot.verification.tables import parse_table
from tightspot.verification.tables.columns import MEANINGS, heading_of
from tightspot.verification.tables.text import MOST_ROWS, decoded

TWO_ROWS = {"t": [0.0, 0.5], "x": [1.0, 1.25], "y": [2.0, 2.0], "theta": [0.0, 0.1]}

FORMATS = {
    "commas": "t,x,y,theta\n0.0,1.0,2.0,0.0\n0.5,1.25,2.0,0.1\n",
    "tabs": "t\tx\ty\ttheta\n0.0\t1.0\t2.0\t0.0\n0.5\t1.25\t2.0\t0.1\n",
    "semicolons": "t;x;y;theta\n0.0;1.0;2.0;0.0\n0.5;1.25;2.0;0.1\n",
    "blanks": "  t    x   y  theta\n0.0  1.0 2.0    0.0\n0.5 1.25 2.0    0.1\n",
    "tabs above blanks": "t\tx\ty\ttheta\n0.0 1.0 2.0 0.0\n0.5 1.25 2.0 0.1\n",
    "byte order mark and carriage returns": "\ufefft,x,y,theta\r\n0.0,1.0,2.0,0.0\r\n\r\n0.5,1.25,2.0,0.1\r\n",
    "old line ends": "t,x,y,theta\r0.0,1.0,2.0,0.0\r0.5,1.25,2.0,0.1",
    "comments": "# made by hand\nt,x,y,theta\n0.0,1.0,2.0,0.0\n# half time\n0.5,1.25,2.0,0.1\n% end\n",
    "names in a comment": "# t x y theta\n0 1 2 0\n0.5 1.25 2 0.1\n",
    "names in a MATLAB comment": "% made by hand\n% t, x, y, psi\n0, 1, 2, 0\n0.5, 1.25, 2, 0.1\n",
    "quotes": '"t","x","y","theta"\n"0.0","1.0","2.0","0.0"\n"0.5","1.25","2.0","0.1"\n',
    "separators at the ends": "t,x,y,theta,\n0.0,1.0,2.0,0.0,\n0.5,1.25,2.0,0.1,\n",
    "separators at the ends of rows": "t,x,y,theta\n0.0,1.0,2.0,0.0,\n0.5,1.25,2.0,0.1,\n",
    "exponents": "t,x,y,theta\n0,1e0,.2E+1,0.\n5e-1,125e-2,2.D0,1d-1\n",
    "decimal commas": "t;x;y;theta\n0,0;1,0;2,0;0,0\n0,5;1,25;2,0;0,1\n",
    "an index without a name": ",t,x,y,theta\n0,0.0,1.0,2.0,0.0\n1,0.5,1.25,2.0,0.1\n",
    "an index that the names leave out": "t\tx\ty\ttheta\n0\t0.0\t1.0\t2.0\t0.0\n1\t0.5\t1.25\t2.0\t0.1\n",
    "an index in blanks": "     t     x    y  theta\n7  0.0  1.00  2.0    0.0\n8  0.5  1.25  2.0    0.1\n",
    "an index and separators at the ends": ",t,x,y,theta,\n0,0.0,1.0,2.0,0.0,\n1,0.5,1.25,2.0,0.1,\n",
    "units in brackets": "time [s], X (m), y_m, Yaw [rad]\n0.0,1.0,2.0,0.0\n0.5,1.25,2.0,0.1\n",
    "units after blanks": "time [s] x [m] y [m] yaw [rad]\n0.0 1.0 2.0 0.0\n0.5 1.25 2.0 0.1\n",
    "units in a line": "t,x,y,theta\ns,m,m,rad\n0.0,1.0,2.0,0.0\n0.5,1.25,2.0,0.1\n",
    "other units": "t [ms],x_cm,y [mm],heading_rad\n0,100,2000,0\n500,125,2000,0.1\n",
    "capitals": "TIME,X,Y,HEADING\n0.0,1.0,2.0,0.0\n0.5,1.25,2.0,0.1\n",
    "another order": "y,theta,t,x\n2.0,0.0,0.0,1.0\n2.0,0.1,0.5,1.25\n",
    "what is not used": "t,x,y,theta,kappa,frame_id,jerk\n0,1,2,0,9,map,0\n.5,1.25,2,.1,9,map,nan\n",
}


@pytest.mark.parametrize("kind", FORMATS)
def test_formats(kind, tmp_path):
    path = tmp_path / "table"
    path.write_bytes(FORMATS[kind].encode())
    table = read_table(path)
    assert set(table.columns) == set(TWO_ROWS)
    for name, values in TWO_ROWS.items():
        assert table.columns[name] == pytest.approx(values, abs=1e-12)


def test_utf_16_as_spreadsheets_write_it(tmp_path):
    path = tmp_path / "table.txt"
    path.write_bytes(FORMATS["tabs"].encode("utf-16"))
    assert read_table(path).columns["x"].tolist() == [1.0, 1.25]


def test_latin_1_as_old_programs_write_it():
    table = parse_table(decoded("x,y,yaw [°]\n0,0,45\n1,1,45\n".encode("latin-1"), "table"))
    assert table.columns["theta"] == pytest.approx(np.pi / 4)


def test_xml_is_no_table():
    with pytest.raises(TableError, match="XML or HTML"):
        decoded(b'<?xml version="1.0"?><a/>', "table")


def test_lines_are_those_of_the_file():
    table = parse_table(FORMATS["comments"])
    assert table.lines.tolist() == [3, 5]


NAMES = {
    "t": ["time", "timestamp", "Time [s]", "t_s", "time_from_start", "elapsed time", "t / s"],
    "x": ["X", "pos_x", "position.x", "/odom/pose/pose/position/x", "x [m]", "x-position", "pose_x", "x_m"],
    "theta": ["yaw", "Heading", "psi", "yaw_deg", "theta (rad)", "orientation", "θ", "heading [°]"],
    "v": ["speed", "velocity", "vel [m/s]", "speed_kmh", "longitudinal_velocity_mps", "twist.linear.x", "v_ms"],
    "delta": ["sigma", "steer", "Steering Angle", "steering", "front_wheel_angle_rad", "delta_f", "steering_angle_deg"],
    "a": ["acc", "accel", "acceleration_mps2", "Acceleration [m/s²]", "acceleration (m/s^2)"],
    "omega": ["w", "steering_rate", "steering rate [rad/s]", "delta_dot", "ω", "phi_dot", "steer_rate_degps"],
    "index": ["index", "Unnamed: 0", "idx", "#", "seq"],
    "ignored": ["kappa", "curvature [1/m]", "yaw_rate", "heading_rate_rps", "pose.covariance[3]", "z", "position.z"],
}


@pytest.mark.parametrize(("meaning", "name"), [(meaning, name) for meaning, names in NAMES.items() for name in names])
def test_names_in_common_use(meaning, name):
    assert heading_of(name).meaning == meaning


def test_units_are_converted():
    table = parse_table(
        "t [ms],x [km],y_cm,yaw_deg,speed_kmh,steering [deg],steering_rate_degps\n0,0,0,0,36,30,90\n9,1,5,90,0,0,0\n"
    )
    expected = {"t": 0.009, "x": 1000, "y": 0.05, "theta": np.pi / 2}
    assert {key: table.columns[key][1] for key in expected} == pytest.approx(expected)
    assert table.columns["v"][0] == pytest.approx(10)
    assert table.columns["delta"][0] == pytest.approx(np.pi / 6)
    assert table.columns["omega"][0] == pytest.approx(np.pi / 2)
    assert any("yaw_deg" in note for note in table.notes)


def test_phi_is_what_the_other_columns_leave_over():
    assert "delta" in parse_table("x,y,theta,phi\n0,0,0,0.3\n1,0,0,0.3\n").columns
    assert "theta" in parse_table("x,y,phi,steering\n0,0,0.3,0\n1,0,0.3,0\n").columns
    with pytest.raises(TableError, match="may be the heading or the steering angle"):
        parse_table("x,y,phi\n0,0,0\n1,0,0\n")


def test_messages_of_robots():
    """As `rostopic echo -p` prints them: nanoseconds since 1970, quaternions, much that is not used."""
    head = (
        "%time,field.header.seq,field.header.stamp,field.header.frame_id,field.pose.position.x,field.pose.position.y,"
    )
    head += "field.pose.position.z," + ",".join(f"field.pose.orientation.{axis}" for axis in "xyzw")
    rows = [
        f"16000000000{k}0000000,{k},16000000000{k}0000000,map,{k},0,0,0,0,{np.sin(k / 20)},{np.cos(k / 20)}"
        for k in (1, 2, 3)
    ]
    table = parse_table("\n".join([head, *rows]))
    assert np.diff(table.columns["t"]) == pytest.approx([0.01, 0.01], abs=1e-6)
    assert table.columns["theta"] == pytest.approx([0.1, 0.2, 0.3])


def test_headings_have_no_jumps():
    table = parse_table("x,y,theta\n0,0,3.1\n-1,0,-3.1\n-2,0,3.0\n")
    assert table.columns["theta"] == pytest.approx([3.1, 2 * np.pi - 3.1, 3.0])


def test_more_than_two_turns_are_no_degrees_if_the_motion_says_so():
    turn = np.linspace(0, 20, 400)
    table = Table.from_columns({"x": 5 * np.sin(turn), "y": 5 - 5 * np.cos(turn), "theta": turn})
    assert table.columns["theta"][-1] == pytest.approx(20)


def test_rounding_is_seen_in_the_digits():
    motion = drive(vehicle("tpcap"), 3, seconds=4)
    for decimals in (3, 4, 6):
        table = parse_table(text(motion, decimals=decimals))
        for name in ("x", "y", "theta", "v", "delta"):
            assert table.rounding[name] == pytest.approx(0.5 * 10.0**-decimals), name
    assert parse_table(text(motion, decimals=None)).rounding["x"] < 1e-12
    assert parse_table("t,x,y\n0,0,0\n0.1,1,0\n0.2,2,0\n").rounding["t"] < 1e-12  # regular times are exact


def test_arrays_and_frames_by_name():
    table = Table.from_columns({"X": [0, 1], "Y": np.zeros(2), "yaw [deg]": (0, 45), "jerk": [0, 0]})
    assert table.columns["theta"] == pytest.approx([0, np.pi / 4])
    with pytest.raises(TableError, match="different lengths"):
        Table.from_columns({"x": [0, 1], "y": [0, 1, 2]})
    with pytest.raises(TableError, match="must be a list of numbers"):
        Table.from_columns({"x": ["a", "b"], "y": [0, 1]})


def test_our_own_trajectory_files(plan, tmp_path):
    path = tmp_path / "trajectory.csv"
    write_trajectory_csv(plan, path, dt=0.1)
    table = read_table(path)
    assert set(table.columns) == set(MEANINGS)
    assert table.columns["x"] == pytest.approx(plan.sample(table.columns["t"])[:, 0])
    assert load_plan  # a plan file is no table
    with pytest.raises(TableError):
        parse_table('{"format": "tightspot-plan/1"}')


def test_names_may_be_given():
    table = parse_table("0 5 1 2 0.1\n1 6 2 2 0.1\n", columns=["t", "-", "x", "y", "theta"])
    assert table.columns["x"].tolist() == [1.0, 2.0]
    other = parse_table("a,b,c\n1,2,0.1\n2,2,0.1\n", columns=["x", "y", "theta"])
    assert other.columns["theta"].tolist() == [0.1, 0.1]
    with pytest.raises(TableError, match="holds 3 values, but there are 2 columns"):
        parse_table("1 2 3\n1 2 3\n", columns=["x", "y"])


WRONG = {
    "no names": ("0,0,0\n1,0,0\n", ["columns", "--columns"]),
    "an unknown column": ("x,y,theta,stearing\n0,0,0,0\n1,0,0,0\n", ["stearing", "did you mean 'steering'"]),
    "no x": ("t,y,theta\n0,0,0\n1,0,0\n", ["column x", "is missing"]),
    "a repeated meaning": ("x,y,theta,yaw\n0,0,0,0\n1,0,0,0\n", ["yaw", "keep one"]),
    "an odd unit": ("x [parsec],y\n0,0\n1,0\n", ["parsec", "known for the x"]),
    "degrees": ("x,y,theta\n0,0,90\n0,1,90\n0,2,90\n", ["theta", "90 rad looks like degrees"]),
    "few degrees": ("x,y,theta\n0,0,9\n1,.16,9\n2,.32,9\n", ["theta", "degrees"]),
    "steering in degrees": ("x,y,theta,delta\n0,0,0,30\n1,0,0,30\n", ["line 2, column 'delta'", "degrees"]),
    "time stands": (
        "t,x,y\n0,0,0\n0,1,0\n1,2,0\n",
        ["line 3, column 't'", "times must increase: keep one of the two rows"],
    ),
    "time runs back": ("t,x,y\n0,0,0\n2,1,0\n1,2,0\n", ["line 4", "1 s does not come after 2 s"]),
    "a day and more": ("t,x,y\n0,0,0\n100000,1,0\n", ["more than a day", "[ms]"]),
    "millimetres": ("t,x,y,v\n0,0,0,1\n.05,50,0,1\n.1,100,0,1\n", ["look like millimetres", "x [mm] and y [mm]"]),
    "centimetres": ("t,x,y,v\n0,0,0,1\n.05,5,0,1\n.1,10,0,1\n", ["look like centimetres", "x [cm] and y [cm]"]),
    "milliseconds": ("t,x,y,v\n0,0,0,1\n50,0.05,0,1\n100,.1,0,1\n", ["looks like milliseconds", "t [ms]"]),
    "NaN": ("x,y\n0,0\nnan,1\n2,2\n", ["line 3, column 'x'", "not a finite number"]),
    "infinity": ("x,y\n0,0\n1,inf\n2,2\n", ["line 3, column 'y'", "finite"]),
    "text": ("x,y\n0,0\n1,abc\n", ["line 3, column 'y'", "'abc' is not a number"]),
    "digits with underscores": ("x,y\n0,0\n1_0,1\n", ["'1_0' is not a number"]),
    "a hole": ("x,y\n0,0\n1,\n2,0\n", ["line 3, column 'y'", "is empty"]),
    "a short row": ("x,y,theta\n0,0,0\n1,0\n2,0,0\n", ["line 3", "holds 2 values, but there are 3"]),
    "one row": ("x,y\n0,0\n", ["at least two"]),
    "no row": ("x,y\n", ["no row"]),
    "comments only": ("# x y\n", ["only comments"]),
    "yaw rate or steering rate": (
        "t,x,y,theta,omega\n0,0,0,0,0\n1,1,0,0,0\n",
        ["omega", "steering rate or the yaw rate"],
    ),
    "too large": ("x,y\n0,0\n1e12,0\n", ["too large"]),
}


@pytest.mark.parametrize("kind", WRONG)
def test_what_is_wrong_is_told(kind):
    content, words = WRONG[kind]
    with pytest.raises(TableError) as caught:
        parse_table(content)
    for word in words:
        assert word in str(caught.value)
    assert all(len(problem.message) < 400 for problem in caught.value.problems)


def test_everything_wrong_is_told_at_once():
    with pytest.raises(TableError) as caught:
        parse_table("t,x,y,foo,v\n0,0,0,1,nan\n0,abc,0,1,1\n1,2\n3,,0,0,0\n")
    paths = [problem.path for problem in caught.value.problems]
    assert paths == [
        "column 'foo'",
        "line 4",
        "line 3, column 'x'",
        "line 5, column 'x'",
        "line 2, column 'v'",
    ]


def test_too_much_is_refused(tmp_path):
    with pytest.raises(TableError, match="thin it out"):
        parse_table("x,y\n" + "1,2\n" * (MOST_ROWS + 10))
    with pytest.raises(TableError, match="one row a line"):
        parse_table("x,y\n" + "1," * 20_000)
    huge = tmp_path / "huge.csv"
    with huge.open("wb") as file:
        file.truncate(60_000_000)
    with pytest.raises(TableError, match="at most 50 MB"):
        read_table(huge)


@pytest.mark.parametrize("content", [b"", b" \n\n", b"\x89PNG\r\n\x1a\n\0\0", bytes(range(256)), b"x,y\n\0,1\n"])
def test_what_is_no_text(content, tmp_path):
    path = tmp_path / "table.csv"
    path.write_bytes(content)
    with pytest.raises(TableError) as caught:
        read_table(path)
    assert str(path) in str(caught.value)


def test_files_that_cannot_be_read(tmp_path):
    for path in (tmp_path, tmp_path / "missing.csv", tmp_path / ("a" * 5000), "nul\0l"):
        with pytest.raises(InputError):
            read_table(path)
