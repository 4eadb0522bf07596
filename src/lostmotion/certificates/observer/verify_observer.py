#!/usr/bin/env python3
"""Checks the bound of an observer's error in exact fractions: python verify_observer.py certificate.json

It needs nothing but Python's standard library. From the file it takes the drivetrain, the observer's gain and
injection, and builds the error's equations itself; the polytope and the multipliers either satisfy the inequalities or
do not. Numbers in brackets are the equations of docs/proofs.md. Exit code 0: proved; 1: not proved.

A *form* is a linear expression in named variables, {name: coefficient}; the name "1" stands for the constant.
"""

import itertools
import json
import sys
from fractions import Fraction

STATES = ("twist", "speed_motor", "speed_load")


#: What reading something else raises.
NO_CERTIFICATE = (LookupError, TypeError, ValueError, AttributeError, ArithmeticError, RecursionError)


class NotProved(Exception):
    """Why a certificate proves nothing."""


def demand(condition, reason):
    if not condition:
        raise NotProved(reason)


def plus(*terms):
    """Sum of coefficient · form over pairs (coefficient, form)."""
    total = {}
    for coefficient, form in terms:
        for name, value in form.items():
            total[name] = total.get(name, 0) + coefficient * value
    return {name: value for name, value in total.items() if value}


class Error:
    """The error e of the observer (19) and what is known of the differences w of its curves (20)."""

    def __init__(self, d, measured, gain, injection):
        j1, j2, k, c = d["inertia_motor"], d["inertia_load"], d["stiffness"], d["damping"]
        demand(min(j1, j2, k) > 0, "an inertia or the stiffness is not positive")
        rest = ("damping", "backlash", "viscous", "viscous_motor", "coulomb_plus", "coulomb_minus",
                "coulomb_motor_plus", "coulomb_motor_minus")  # fmt: skip
        demand(min(d[name] for name in rest) >= 0, "a parameter of the drivetrain is negative")
        demand(d["contact"] in ("viscoelastic", "dead_zone"), "a contact law without a Lur'e form")
        demand(d["lag"] == 0, "a torque lag")
        self.rates, self.arguments, self.limits, self.jumps = {}, {}, {}, {}
        one, rate = Fraction(1), {"speed_motor": Fraction(1), "speed_load": Fraction(-1)}
        shaft = plus((k, {"twist": one}), (c, rate))
        if d["backlash"] > Fraction(1e-10):  # less counts as none
            lead = c / k if d["contact"] == "viscoelastic" else 0
            self.add("gap", plus((1, {"twist": one}), (lead, rate)), d["backlash"], False)
            shaft = plus((1, shaft), (-k, {"gap": one}))
        friction = {"motor": {}, "load": {}}
        for place, suffix in (("motor", "_motor"), ("load", "")):
            height = d[f"coulomb{suffix}_plus"] + d[f"coulomb{suffix}_minus"]
            friction[place] = plus((d[f"viscous{suffix}"], {f"speed_{place}": one}))
            if height:
                self.add(f"friction_{place}", {f"speed_{place}": one}, height, True)
                friction[place] = plus((1, friction[place]), (1, {f"friction_{place}": one}))
        self.rates["twist"] = rate
        self.rates["speed_motor"] = plus((-1 / j1, shaft), (-1 / j1, friction["motor"]))
        self.rates["speed_load"] = plus((1 / j2, shaft), (-1 / j2, friction["load"]))
        self.correct({**{name: {name: one} for name in STATES}, "torque_shaft": shaft}, measured, gain)
        self.inject(d, measured, injection)

    def add(self, name, argument, limit, jumps):
        self.arguments[name], self.limits[name], self.jumps[name] = argument, limit, jumps

    def correct(self, innovations, measured, gain):
        """ė = … − gain · (measured − expected) (19)."""
        demand(len(set(measured)) == len(measured) and set(measured) <= set(innovations), "an unknown sensor")
        demand(len(gain) == 3 and all(len(row) == len(measured) for row in gain), "a gain of another size")
        for name, row in zip(STATES, gain):
            corrections = [(-value, innovations[signal]) for value, signal in zip(row, measured)]
            self.rates[name] = plus((1, self.rates[name]), *corrections)

    def inject(self, d, measured, injection):
        """What the observer adds to its gap's argument beside what is measured (20)."""
        demand(set(injection) <= set(measured), "an injection of what is not measured")
        left = 1 - injection.get("torque_shaft", 0) * d["stiffness"]
        demand(left > 0, "an injection for which the gap has no single value")
        for signal, factor in injection.items() if "gap" in self.arguments else ():
            expected = {signal: Fraction(1)}
            if signal == "torque_shaft":
                damping = d["damping"] if d["contact"] == "dead_zone" else 0
                expected = {"speed_motor": damping, "speed_load": -damping}
            self.arguments["gap"] = plus((1, self.arguments["gap"]), (-factor / left, expected))

    def known(self, signs, faces):
        """Forms that are ≥ 0 in the polytope where the differences have these signs (20)."""
        forms = []
        for name, sign in zip(self.arguments, signs):
            w, z = {name: Fraction(sign)}, plus((sign, self.arguments[name]))
            forms += [w, plus((1, {"1": self.limits[name]}), (-1, w)), z]
            if not self.jumps[name]:
                forms.append(plus((1, z), (-1, w)))
        inside = [plus((1, {"1": Fraction(1)}), (-1, face)) for face in faces]
        return forms + inside + [plus((1, {"1": Fraction(1)}), (1, face)) for face in faces]


def falls(error, h, known, multipliers, bounds, decay):
    """(21): on the face h·e = 1, h·ė ≤ −decay for the signs of the differences for which all ``known`` is ≥ 0."""
    total = plus((-1, {"1": decay}), *((-value, error.rates[name]) for name, value in h.items()))
    terms = [(-multipliers["face"], plus((1, {"1": Fraction(1)}), (-1, h)))]
    for place, value in multipliers["known"]:
        demand(place.denominator == 1 and 0 <= place < len(known) and value >= 0, "no multiplier")
        terms.append((-value, known[int(place)]))
    total = plus((1, total), *terms)
    # What rounding has left of the variables is bounded by their limits.
    left = sum(abs(value) * bounds[name] for name, value in total.items() if name != "1")
    return total.get("1", 0) >= left


def verify(certificate):
    """The claim that is proved; raises ``NotProved``."""
    claim, proof = certificate["claim"], certificate["proof"]
    error = Error(
        certificate["drivetrain"], certificate["measured"], certificate["gain"], certificate["injection"]
    )
    demand(claim["decay"] > 0 and set(claim["bounds"]) == set(STATES), "no decay or no bounds in the claim")
    faces = []
    for row in proof["faces"]:
        demand(len(row) == 3, "a face of another size")
        faces.append(plus((1, dict(zip(STATES, row)))))
    demand(len(faces) >= 3, "too few faces")
    for face, name in zip(faces, STATES):  # the first three bound one state each (22)
        bound = claim["bounds"][name]
        demand(
            bound > 0 and set(face) == {name} and face[name] * bound >= 1, f"{name} is not within its bound"
        )
    bounds = {**claim["bounds"], **error.limits}
    choices = [error.known(signs, faces) for signs in itertools.product((1, -1), repeat=len(error.arguments))]
    demand(len(proof["multipliers"]) == len(faces), "not as many multipliers as faces")
    for number, of_face in enumerate(proof["multipliers"]):
        demand(len(of_face) == len(choices), "not as many multipliers as signs")
        for known, multipliers in zip(choices, of_face):
            proved = falls(error, faces[number], known, multipliers, bounds, claim["decay"])
            demand(proved, f"the error leaves through face {number} (21)")
    return claim


def refused(text):
    raise NotProved(f"{text} is no number")


def parsed(text):
    """JSON in exact fractions: the number that each decimal means as a float."""
    return json.loads(
        text, parse_float=lambda digits: Fraction(float(digits)), parse_int=Fraction, parse_constant=refused
    )


def main(paths):
    if len(paths) != 1:
        print(__doc__)
        return 2
    try:
        with open(paths[0], encoding="utf-8") as file:  # noqa: PTH123 (a script without further imports)
            claim = verify(parsed(file.read()))
    except NotProved as reason:
        print(f"NOT PROVED: {reason}")
        return 1
    except (OSError, *NO_CERTIFICATE) as error:
        print(f"NOT PROVED: the file is no certificate ({type(error).__name__}: {error})")
        return 1
    print("PROVED: during every motion the observer's error enters and stays within")
    for name, bound in claim["bounds"].items():
        print(f"        {name}: {float(bound)!r} {'rad' if name == 'twist' else 'rad/s'}")
    print(f"        Outside, its measure decays at {float(claim['decay'])!r} 1/s or more.")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
