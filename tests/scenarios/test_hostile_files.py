"""Large and malicious files of every format: one clear error each within seconds and 1 GB, in a process of its own."""

from __future__ import annotations

import json
import struct
import subprocess
import sys
import zlib

import pytest

from .peak import PRINT_PEAK

SECONDS, BYTES = 5, 1_000_000_000
RING = ",".join(["[1,2],[3,2],[3,4],[1,4]"] * 250_000)
PAIRS = ", ".join(["1 2, 3 2, 3 4, 1 4"] * 250_000)
ENDS = "start; POINT (0 0); theta=0\ngoal; POINT (9 1); theta=0\n"
MAP = json.dumps({"image": "image.bin", "resolution": 0.05, "origin": [0, 0, 0]})


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def png(width, height, raw, extra=b""):
    header = chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0))
    return b"\x89PNG\r\n\x1a\n" + header + extra + chunk(b"IDAT", zlib.compress(raw, 9)) + chunk(b"IEND", b"")


def laughs():
    lines = ["a0: &a0 [x, x, x, x, x, x, x, x, x, x]"]
    lines += [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 10)}]" for i in range(1, 10)]
    return "\n".join([*lines, "image: x.pgm", "resolution: *a9"])


# The file, the picture beside it if it is a map, and a word of the answer.
FILES = {
    "million.geojson": (f'{{"type":"Polygon","coordinates":[[{RING}]]}}', b"", "holds more than"),
    "million.json": (f'{{"obstacles":[{{"vertices":[{RING}]}}]}}', b"", "holds more than"),
    "million.wkt": (f"{ENDS}POLYGON (({PAIRS}, 1 2))", b"", "more than 50000 points"),
    "million.csv": ("0,0,0,9,1,0,1,1000000," + RING.replace("[", "").replace("]", ""), b"", "more numbers"),
    "lines.wkt": ("POINT (1 2)\n" * 700_000, b"", "more than 50000 points"),
    "features.geojson": (
        '{"type":"FeatureCollection","features":['
        + ",".join(['{"type":"Feature","geometry":{"type":"Point","coordinates":[1,2]}}'] * 120_000)
        + "]}",
        b"",
        "holds more than",
    ),
    "deep.geojson": ('{"type":"GeometryCollection","geometries":[' * 200_000, b"", "levels deep"),
    "deep.wkt": (ENDS + "GEOMETRYCOLLECTION (" * 400_000, b"", "levels deep"),
    "laughs.yaml": (laughs(), b"", "aliases"),
    "quotes.wkt": ('"' * 9_000_000, b"", "neither a role"),
    "backslashes.wkt": ('"' + "\\" * 9_000_000, b"", "neither a role"),
    "semicolons.wkt": (";" * 9_000_000, b"", "no geometry"),
    "cell.csv": ('role,wkt\nobstacle,"' + "(" * 9_000_000 + '"', b"", "limit"),
    "pixels.yaml": (MAP, png(100_000, 100_000, bytes(1_000_000)), "exceeds limit"),
    "more-data.yaml": (MAP, png(20, 20, bytes(150_000_000)), "start: is"),
    "text.yaml": (MAP, png(4, 4, bytes(20), chunk(b"zTXt", b"a\0\0" + zlib.compress(bytes(150_000_000)))), "too large"),
    "lying.yaml": (MAP, b"P5\n999999999 999999999\n255\n", "at most"),
    "large.yaml": (MAP, b"P5\n4096 4096\n255\n" + bytes(100), "holds 100 of"),
    "plain.yaml": (MAP, b"P2\n4096 4096\n255\n" + b"7 " * 5_000_000, "holds 5000000 of"),
    "comments.yaml": (MAP, b"P5\n" + b"#\n" * 9_000_000, "not readable as PGM"),
    "noise.yaml": (MAP, b"P5\n4096 4096\n255\n" + bytes([0, 254] * 8_388_608), "sides"),
}

PROGRAM = f"""
import resource, sys, time
from tightspot.scenarios import load
from tightspot.errors import SceneError
resource.setrlimit(resource.RLIMIT_CPU, (60, 60))
began = time.process_time()
try:
    load(sys.argv[1], **(dict(start=(1, 1, 0), goal=(3, 1, 0)) if sys.argv[2] == "ends" else dict()))
    sentence = "read"
except SceneError as error:
    sentence = str(error.problems[0])
print(time.process_time() - began)
{PRINT_PEAK}
print(sentence)
"""


@pytest.mark.parametrize("name", FILES)
def test_one_clear_error_in_seconds_and_in_bounded_memory(tmp_path, name):
    content, picture, words = FILES[name]
    if picture:
        pytest.importorskip("PIL")
        (tmp_path / "image.bin").write_bytes(picture)
    (tmp_path / name).write_text(content)
    ends = "ends" if picture and "start" not in words else "no"
    command = [sys.executable, "-W", "error", "-c", PROGRAM, str(tmp_path / name), ends]
    run = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    assert run.stderr == ""
    assert run.returncode == 0
    seconds, memory, sentence = run.stdout.split("\n", 2)
    assert words in sentence
    assert len(sentence) < 500
    assert float(seconds) < SECONDS
    assert int(memory) < BYTES
