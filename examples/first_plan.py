"""Plan a built-in scene, check the stored plan again, draw it."""

import tightspot
from tightspot import plotting

plan = tightspot.plan("vertical", margin=0.05)
print("\n".join(plan.certificate.summary()))

tightspot.save_plan(plan, "plan.json")
verdict = tightspot.verify_plan(tightspot.load_plan("plan.json"))
print("upheld" if verdict.upheld else "not upheld")

plotting.show_plan(plan, "plan.png")
