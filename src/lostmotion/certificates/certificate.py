"""A certificate: the claim, drivetrain and law that it is about, and the numbers that prove it, as plain data."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np

from ..argument_checks import checks_arguments
from ..drivetrain import Drivetrain
from ..systems import DiscreteSystem, pruned
from . import verify_certificate
from .sampled_proof import SampledProof
from .semidefinite import Unknowns

#: Bits of the numbers that are written (numerics): fewer make the check faster; ten digits are enough for every margin
#: that the solver finds.
BITS = 34


def short(values: np.ndarray) -> np.ndarray:
    """The numbers rounded to ``BITS`` bits."""
    mantissa, exponent = np.frexp(values)
    return np.asarray(np.ldexp(np.round(np.ldexp(mantissa, BITS)), exponent - BITS))


def drivetrain_data(drivetrain: Drivetrain) -> dict[str, Any]:
    """The parameters that a proof is about, SI."""
    motor, load = drivetrain.frictions
    limit = drivetrain.actuator.torque_limit
    return {
        "inertia_motor": drivetrain.inertia_motor, "inertia_load": drivetrain.inertia_load,
        "stiffness": drivetrain.stiffness, "damping": drivetrain.damping, "backlash": drivetrain.backlash,
        "contact": drivetrain.contact,
        "coulomb_plus": load.coulomb_plus, "coulomb_minus": load.coulomb_minus, "viscous": load.viscous,
        "coulomb_motor_plus": motor.coulomb_plus, "coulomb_motor_minus": motor.coulomb_minus,
        "viscous_motor": motor.viscous, "lag": drivetrain.lag,
        "torque_limit": float(limit) if np.isfinite(limit) else None,
    }  # fmt: skip


def proof_data(proof: SampledProof, unknowns: Unknowns) -> dict[str, Any]:
    """P at each knot and all multipliers, in the order in which the verifier needs them."""

    def parts(where: str, count: int) -> list[list[float]]:
        each = zip(
            unknowns[f"{where}_sectors"].reshape(count, -1),
            unknowns[f"{where}_copies"].reshape(count, -1),
            strict=True,
        )
        return [[*map(float, sectors), *map(float, copies)] for sectors, copies in each]

    knots, ends = proof.substeps + 1, 2 * proof.substeps
    multipliers = {
        name: unknowns[name].tolist() for name in ("eta_plus", "eta_minus", "theta_plus", "theta_minus")
    }
    multipliers |= {f"rest_{k}": values for k, values in enumerate(parts("rest", knots))}
    multipliers |= {f"flow_{i // 2}_{i % 2}": values for i, values in enumerate(parts("flow", ends))}
    multipliers["jump"] = parts("jump", 1)[0]
    if proof.limit is not None:
        multipliers |= {"level": unknowns["level"].tolist(), "region": parts("region", 1)[0]}
    return {
        "substeps": proof.substeps,
        "P": [unknowns[f"P{k}"].tolist() for k in range(knots)],
        "multipliers": multipliers,
    }


def certificate(
    drivetrain: Drivetrain,
    law: DiscreteSystem,
    delay: int,
    claim: Mapping[str, Any],
    segments: tuple[int, ...],
    proof: Mapping[str, Any],
) -> dict[str, Any]:
    """All that the verifier needs, as JSON can hold it."""
    return {
        "claim": dict(claim),
        "drivetrain": drivetrain_data(drivetrain),
        "law": pruned(law, ("torque_motor",)).to_dict(),
        "delay": delay,
        "segments": list(segments),
        "proof": dict(proof),
    }


@checks_arguments
def verdict(data: Mapping[str, Any]) -> str | None:
    """None if the certificate is proved in exact fractions, else why not; the verifier's own word."""
    return word_of(verify_certificate, data)


def word_of(verifier: Any, data: Mapping[str, Any]) -> str | None:
    """What a verifier, a module, says of a certificate: None where it is proved, else the reason."""
    try:
        verifier.verify(verifier.parsed(json.dumps(data)))
    except verifier.NotProved as reason:
        return str(reason)
    except verifier.NO_CERTIFICATE as error:
        return f"no certificate ({type(error).__name__}: {error})"
    return None
