"""Write random scenes as scene files: ``python -m benchmarks.random_scenes --seed 1 --count 20 --output DIR``."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import yaml

from benchmarks.random_scenes.scene import RandomScene, random_scene
from tightspot.files import atomic_write


def write(scene: RandomScene, directory: Path) -> Path:
    """The scene as ``<its name>.yaml`` in the directory."""
    path = directory / f"{scene.scenario.name}.yaml"
    text = yaml.safe_dump(scene.scenario.to_dict(), sort_keys=False, default_flow_style=None, width=120)
    atomic_write(path, text)
    return path


def main() -> int:
    """Draw, write, and say what was drawn."""
    parser = argparse.ArgumentParser(description="Write random scenes as scene files.")
    parser.add_argument("--seed", type=int, default=1, help="of the sequence")
    parser.add_argument("--first", type=int, default=0, metavar="INDEX", help="where in the sequence to begin")
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--output", type=Path, required=True, metavar="DIR")
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    sys.stdout.write(f"seed {options.seed}\n")
    for index in range(options.first, options.first + options.count):
        scene = random_scene(options.seed, index)
        ratio, margin = f"{scene.ratio:.3f}", scene.scenario.margin
        path = write(scene, options.output)
        sys.stdout.write(f"{path}: {scene.kind}; {scene.scenario.vehicle}, ratio {ratio}, margin {margin:g} m\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
