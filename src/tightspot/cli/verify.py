"""``tightspot verify``: does a plan file's certificate hold? No optimiser is loaded for that."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from tightspot.cli.console import answers, print_json, print_line
from tightspot.cli.failures import REFUSED
from tightspot.cli.summary import certificate_facts


def verify_command(
    plan_file: Annotated[Path, typer.Argument(metavar="PLAN.json", help="A plan file.")],
    json: Annotated[bool, typer.Option("--json", help="Print one JSON object on standard output.")] = False,
) -> None:
    """Check a plan's certificate against its scenario, vehicle and trajectory.

    Exit code 0 if it is upheld, 1 if it is not, 2 if the file is no plan.
    """
    from tightspot.verification import load_plan, verify_plan

    plan = load_plan(plan_file)
    verdict = verify_plan(plan)
    if json:
        judged = verdict.certificate
        print_json(
            {
                "status": "upheld" if verdict.upheld else "not-upheld",
                "certificate": certificate_facts(plan.certificate),
                "stored_certificate_proves_its_claim": verdict.stored.ok,
                "reasons": list(verdict.stored.reasons),
                "judged_anew": {
                    **certificate_facts(judged),
                    "failed": [check.sentence for check in judged.failed],
                    "witnesses": [asdict(witness) for witness in judged.witnesses],
                },
            }
        )
    else:
        console = answers()
        for line in verdict.summary():
            print_line(console, line)
    if not verdict.upheld:
        raise typer.Exit(REFUSED)
