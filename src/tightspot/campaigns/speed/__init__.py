"""How much faster than the paper's method: every figure a ratio taken in one process, with its distribution."""

from tightspot.campaigns.speed.report import speed_report
from tightspot.campaigns.speed.run import FULL, QUICK, SpeedPlan, run_speed

__all__ = ["FULL", "QUICK", "SpeedPlan", "run_speed", "speed_report"]
