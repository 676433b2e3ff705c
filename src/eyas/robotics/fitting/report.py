"""What `eyas drone fit` prints."""

from collections.abc import Iterator

from eyas.robotics.fitting.fit import Fit, FittedConstant


def lines(fit: Fit, mass: float | None, thrust_constant: float | None) -> Iterator[str]:
    """Yield lines that tell a fit.

    Args:
        mass: Of the drone, where it is known [kg].
        thrust_constant: Thrust of a rotor over its squared rate, where it is known.
    """
    yield f"flight of {fit.seconds:.1f} s at {fit.rate:.0f} Hz; the last quarter is held out"
    yield _row("thrust / (mass rate^2)", fit.thrust, "m")
    yield _row("drag area / mass", fit.drag, "m^2/kg")
    yield _row("time constant of the rotors", fit.lag, "s")
    yield f"{'rate in hover':28} {fit.hover:.4g}"
    for name, estimate, unit in _absolute(fit, mass, thrust_constant):
        yield _row(name, estimate, unit)
    yield (
        f"held out: force per mass {fit.error:.3g} m/s^2 off of {fit.spread:.3g}, "
        f"velocity after {fit.ahead:.2g} s {fit.speed_error:.3g} m/s off"
    )


def record(fit: Fit, mass: float | None, thrust_constant: float | None) -> dict[str, object]:
    """Return a fit as JSON has it: estimates as value, low, high."""
    told: dict[str, object] = {
        "thrust_over_mass": _told(fit.thrust),
        "drag_area_over_mass": _told(fit.drag),
        "motor_time_constant": _told(fit.lag),
        "hover_rate": fit.hover,
    }
    for name, estimate, _ in _absolute(fit, mass, thrust_constant):
        told[name.replace(" ", "_")] = _told(estimate)
    return told | {
        "seconds": fit.seconds,
        "rows_per_second": fit.rate,
        "held_out_error": fit.error,
        "held_out_spread": fit.spread,
        "held_out_seconds_ahead": fit.ahead,
        "held_out_velocity_error": fit.speed_error,
    }


def _absolute(
    fit: Fit, mass: float | None, thrust_constant: float | None
) -> Iterator[tuple[str, FittedConstant, str]]:
    """Yield what follows where the mass, or what gives it, is known."""
    drag = fit.drag
    if thrust_constant is not None:
        low, high = thrust_constant / fit.thrust.high, thrust_constant / fit.thrust.low
        weighed = FittedConstant(thrust_constant / fit.thrust.value, low, high)
        yield "mass", weighed, "kg"
        mass = weighed.value
    elif mass is not None:
        yield "thrust constant", fit.thrust.times(mass), "N / rate^2"
    if mass is not None:
        yield "drag area", drag.times(mass), "m^2"


def _told(estimate: FittedConstant) -> list[float]:
    return [estimate.value, estimate.low, estimate.high]


def _row(name: str, estimate: FittedConstant, unit: str) -> str:
    doubt = "" if estimate.is_determined else "; this flight hardly tells"
    span = f"{estimate.low:.4g} to {estimate.high:.4g}"
    return f"{name:28} {estimate.value:.4g} {unit} ({span}{doubt})"
