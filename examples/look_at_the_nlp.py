"""Building and solving are separate steps: look at the nonlinear program before solving it."""

from tightspot.formulations import UnitNormalLine
from tightspot.guesses import HybridAStar
from tightspot.scenarios import load
from tightspot.solvers import Ipopt
from tightspot.transcription import Settings, TimeGrid, transcribe
from tightspot.verification import verify

scene = load("oblique")
car = scene.vehicle_model()
guess = HybridAStar().make(scene, car, margin=0.05)
print(guess.reason)

settings = Settings(formulation=UnitNormalLine(), margin=0.05)
transcription = transcribe(scene, car, guess.trajectory, settings, grid=TimeGrid.uniform(30))
nlp = transcription.nlp
print(f"{nlp.n_variables} variables, {nlp.n_rows} rows, {len(nlp.stages)} stages")

report = Ipopt().solve(nlp)
print(report.status.sentence, f"J = {report.objective:.4f} after {report.iterations} iterations")

# Lines at the knots promise nothing between them; the judge looks at all times.
certificate = verify(scene, car, transcription.trajectory(report.x), margin=0.0)
print("\n".join(certificate.summary()))
