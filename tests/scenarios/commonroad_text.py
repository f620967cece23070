"""CommonRoad scenarios as other programs write them, for the tests: text, piece by piece."""

from __future__ import annotations

from collections.abc import Sequence


def point(x: object, y: object) -> str:
    return f"<point><x>{x}</x><y>{y}</y></point>"


def exact(name: str, value: object) -> str:
    return f"<{name}><exact>{value}</exact></{name}>"


def interval(name: str, low: object, high: object) -> str:
    return f"<{name}><intervalStart>{low}</intervalStart><intervalEnd>{high}</intervalEnd></{name}>"


def state(x: object = 0, y: object = 0, theta: object = 0, *, name: str = "initialState", more: str = "") -> str:
    position = f"<position>{point(x, y)}</position>"
    return f"<{name}>{position}{exact('orientation', theta)}{exact('time', 0)}{more}</{name}>"


def _center(center: tuple[object, object] | None) -> str:
    return "" if center is None else f"<center><x>{center[0]}</x><y>{center[1]}</y></center>"


def rectangle(length: object, width: object, center: tuple[object, object] | None = None, theta: object = None) -> str:
    turned = "" if theta is None else f"<orientation>{theta}</orientation>"
    return f"<rectangle><length>{length}</length><width>{width}</width>{turned}{_center(center)}</rectangle>"


def circle(radius: object, center: tuple[object, object] | None = None) -> str:
    return f"<circle><radius>{radius}</radius>{_center(center)}</circle>"


def polygon(*corners: tuple[object, object]) -> str:
    return f"<polygon>{''.join(point(*corner) for corner in corners)}</polygon>"


def static(number: int, shape: str, at: str = "", kind: str = "parkedVehicle") -> str:
    return f'<staticObstacle id="{number}"><type>{kind}</type><shape>{shape}</shape>{at or state()}</staticObstacle>'


def moving(number: int, *poses: tuple[float, float, float]) -> str:
    (first, *rest), shape = poses, rectangle(4, 2)
    trajectory = "".join(state(*pose, name="state") for pose in rest)
    return (
        f'<dynamicObstacle id="{number}"><type>car</type><shape>{shape}</shape>{state(*first)}'
        f"<trajectory>{trajectory}</trajectory></dynamicObstacle>"
    )


def lanelet(number: int, left: Sequence[tuple[float, float]], right: Sequence[tuple[float, float]]) -> str:
    bounds = [
        f"<{name}>{''.join(point(*corner) for corner in bound)}</{name}>"
        for name, bound in (("leftBound", left), ("rightBound", right))
    ]
    return f'<lanelet id="{number}">{"".join(bounds)}<laneletType>urban</laneletType></lanelet>'


def goal(position: str = circle(1, (20, 0)), more: str = interval("orientation", -0.2, 0.2), steps: object = 99) -> str:
    region = f"<position>{position}</position>" if position else ""
    return f"<goalState>{interval('time', 0, steps)}{region}{more}</goalState>"


def problem(number: int = 5, start: str = "", goals: str = "") -> str:
    return (
        f'<planningProblem id="{number}">{start or state(more=exact("velocity", 0))}{goals or goal()}</planningProblem>'
    )


def scenario(*parts: str, version: str = "2020a", dt: object = "0.1", problems: str | None = None) -> str:
    header = f'timeStepSize="{dt}" commonRoadVersion="{version}" benchmarkID="DEU_Test-1_1_T-1" date="2020-01-07"'
    where = "<geoNameId>-999</geoNameId><gpsLatitude>999</gpsLatitude><gpsLongitude>999</gpsLongitude>"
    head = f"<location>{where}</location><scenarioTags><urban/></scenarioTags>"
    body = "".join(parts) + (problem() if problems is None else problems)
    return (
        f'<?xml version="1.0" encoding="UTF-8"?>\n<commonRoad {header} author="x" affiliation="x" source="x">'
        f"{head}{body}</commonRoad>"
    )
