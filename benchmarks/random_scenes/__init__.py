"""Random scenes to plan in: a sequence for every seed, the same one everywhere."""

from benchmarks.random_scenes.scene import CARS, FAMILIES, RandomScene, random_scene

__all__ = ["CARS", "FAMILIES", "RandomScene", "random_scene"]
