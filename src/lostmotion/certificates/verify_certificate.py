#!/usr/bin/env python3
"""Checks a stability certificate in exact fractions: python verify_certificate.py certificate.json [law.json]

It needs nothing but Python's standard library and trusts nothing in the file but the drivetrain and the law: it builds
the loop, its equilibria and the sectors of its curves itself, and takes from the file only the matrices P and the
multipliers, which either satisfy the inequalities or do not. With law.json it also checks that the certificate is
about that law. Numbers in brackets are the equations of docs/proofs.md. Exit code 0: proved; 1: not proved.

How to read it: ``verify`` says what is checked, in its order. Forms, ``positive_definite`` and ``solve`` are school
algebra; ``Curve`` and ``Loop`` build the system (1 to 3), ``equilibrium``, ``sectors_of`` and ``copies_of`` what is
known of it (4 to 9), and ``Proof`` holds the inequalities, ``holds`` first. What is about a region counts where the
claim has a limit alone, the last part where it has a box alone.

A *form* is a linear expression in named variables, {name: coefficient}. A *quadratic* is {(name, name): coefficient}.
"""

import json
import sys
from fractions import Fraction
from itertools import combinations

#: Numerics.
HALF = Fraction(1, 2)

#: Bits behind the point in the test for positive definiteness (numerics): the margins of proofs are above 2^-40.
BITS = 96

#: Rows and columns of the law's matrices: states, inputs, curves, outputs.
SHAPES = {"A": "xx", "B": "xu", "E": "xw", "F": "wx", "G": "wu", "H": "ww", "C": "yx", "D": "yu", "J": "yw"}


#: What is claimed, beside a box; and the numbers that prove it.
CLAIM = {"speed_from", "speed_to", "torque_load", "both_directions", "limit"}
NUMBERS = {"substeps", "P", "multipliers", "memory"}

#: What reading something else raises.
NO_CERTIFICATE = (LookupError, TypeError, ValueError, AttributeError, ArithmeticError, RecursionError)


class NotProved(Exception):
    """Why a certificate proves nothing."""


def demand(condition, reason):
    if not condition:
        raise NotProved(reason)


def whole(number, least):
    """A number of things, at least so many."""
    demand(number.denominator == 1 and number >= least, "a number of things that is none")
    return int(number)


# --- forms and quadratics -----------------------------------------------------------------------------------------


def plus(*terms):
    """Sum of coefficient · form over pairs (coefficient, form)."""
    total = {}
    for coefficient, form in terms:
        if coefficient:
            for name, value in form.items():
                total[name] = total.get(name, 0) + coefficient * value
    return {name: value for name, value in total.items() if value}


def minus(a, b):
    return plus((1, a), (-1, b))


def replaced(form, by):
    """The form with variables replaced by forms."""
    return plus(*((value, by.get(name, {name: Fraction(1)})) for name, value in form.items()))


def add_product(quadratic, factor, a, b):
    """Adds factor · a · b."""
    if factor:
        for i, x in a.items():
            for j, y in b.items():
                quadratic[i, j] = quadratic.get((i, j), 0) + factor * x * y


def positive_definite(quadratic, names):
    """Whether the quadratic is positive for all values but zero; what it calls so, is.

    Variables are scaled by powers of two until the diagonal lies in 1/4 ... 4, the entries rounded to ``BITS`` bits,
    and the most that rounding can have added, less than 1 unit for each entry of a row, is taken off the diagonal. The
    rest are whole numbers: elimination (Bareiss 1968), whose pivots are the leading minors (Sylvester).
    """
    place = {name: i for i, name in enumerate(names)}
    matrix = [[Fraction(0)] * len(names) for _ in names]
    for (a, b), value in quadratic.items():
        matrix[place[a]][place[b]] += value * HALF
        matrix[place[b]][place[a]] += value * HALF
    if any(matrix[i][i] <= 0 for i in range(len(names))):
        return False
    diagonal = [matrix[i][i] for i in range(len(names))]
    scale = [Fraction(2) ** ((d.denominator.bit_length() - d.numerator.bit_length()) // 2) for d in diagonal]
    rows = [
        [round(v * scale[i] * scale[j] * 2**BITS) for j, v in enumerate(row)] for i, row in enumerate(matrix)
    ]
    for i, row in enumerate(rows):
        row[i] -= len(names)
    last = 1
    for i in range(len(names)):
        pivot = rows[i][i]
        if pivot <= 0:
            return False
        for j in range(i + 1, len(names)):
            for k in range(j, len(names)):
                rows[j][k] = (rows[j][k] * pivot - rows[i][j] * rows[i][k]) // last
        last = pivot
    return True


def solve(equations, unknowns):
    """Values of the unknowns for which every form is zero; the name "1" stands for the constant."""
    rows = [[form.get(name, Fraction(0)) for name in (*unknowns, "1")] for form in equations]
    demand(len(rows) == len(unknowns), "the equilibrium has not as many equations as unknowns")
    for i in range(len(rows)):
        pivot = next((j for j in range(i, len(rows)) if rows[j][i]), None)
        demand(pivot is not None, "the loop has no single equilibrium")
        rows[i], rows[pivot] = rows[pivot], rows[i]
        first = rows[i][i]
        rows[i] = [value / first for value in rows[i]]
        for j, row in enumerate(rows):
            if j != i and row[i]:
                factor = row[i]
                rows[j] = [a - factor * b for a, b in zip(row, rows[i])]
    return {name: -row[-1] for name, row in zip(unknowns, rows)}


# --- curves -------------------------------------------------------------------------------------------------------


class Curve:
    """w(z) through points, with end slopes; two points with one z are a jump (2)."""

    def __init__(self, points, left, right):
        self.points, self.left, self.right = points, left, right
        self.slopes = [left]
        for (z0, w0), (z1, w1) in zip(points, points[1:]):
            demand(z1 > z0 or (z1 == z0 and w1 > w0), "a curve's points are not in order")
            self.slopes.append((w1 - w0) / (z1 - z0) if z1 > z0 else None)
        self.slopes.append(right)
        self.rises = all(slope is None or slope >= 0 for slope in self.slopes)
        self.steepest = None if None in self.slopes else max(self.slopes)
        self.key = (tuple(points), left, right)

    def segment(self, z):
        demand(all(z != point for point, _ in self.points), "an equilibrium lies on a corner of a curve")
        return sum(point < z for point, _ in self.points)

    def line(self, segment):
        """(c, m): the segment lies on c + m·z."""
        demand(0 <= segment < len(self.slopes), "a segment that a curve does not have")
        slope = self.slopes[segment]
        demand(slope is not None, "an equilibrium on a jump")
        z, w = self.points[max(segment - 1, 0)]
        return w - slope * z, slope

    def sector(self, z):
        """Smallest and largest slope of a chord from z (7)."""
        value, slope = self.line(self.segment(z))
        here = value + slope * z
        chords = [slope, self.left, self.right] + [(w - here) / (x - z) for x, w in self.points]
        return min(chords), max(chords)


def normalised(points, left, right):
    """curve(z) = a·z + b·σ(z), σ of height 1 where the end slopes are alike (2)."""
    if left != right:
        return Fraction(0), Fraction(1), Curve(points, left, right)
    flat = [(z, w - right * z) for z, w in points]
    height = flat[-1][1] - flat[0][1] or Fraction(1)
    if height == 1 and flat[-1][1] == flat[0][1]:
        return right, Fraction(1), Curve(flat, Fraction(0), Fraction(0))
    return right, height, Curve([(z, w / height) for z, w in flat], Fraction(0), Fraction(0))


# --- the loop -----------------------------------------------------------------------------------------------------


class Loop:
    """Forms of the loop: rates of the plant (1), values after a sample (3), arguments and curves of both (2)."""

    def __init__(self, drivetrain, law, delay, memory=()):
        self.rates, self.jump, self.arguments, self.curves = {}, {}, {}, {}
        measured = self.add_plant(drivetrain)
        self.plant_states, self.plant_curves = list(self.rates), list(self.curves)
        self.add_law(law, measured, delay, drivetrain["torque_limit"])
        self.add_memory(memory)
        self.law_curves = [name for name in self.curves if name not in self.plant_curves]
        self.states = [*self.plant_states, *self.jump]

    def add_memory(self, places):
        """Arguments of curves at the last sample as states more, and the curves' values then as curves (27)."""
        names = list(self.curves)
        for place in places:
            name = names[whole(place, 0)]
            state, own = f"law: {name} at the last sample", f"{name} at the last sample"
            demand(state not in self.jump, "two states of one name")
            self.jump[state] = self.arguments[name]
            self.curves[own], self.arguments[own] = self.curves[name], {state: Fraction(1)}

    def add_plant(self, d):
        """Two inertias, a shaft with backlash, friction, the actuator's lag: (1)."""
        j1, j2, k, c = d["inertia_motor"], d["inertia_load"], d["stiffness"], d["damping"]
        demand(min(j1, j2, k) > 0, "an inertia or the stiffness is not positive")
        rest = ("damping", "backlash", "viscous", "viscous_motor", "lag", "coulomb_plus", "coulomb_minus",
                "coulomb_motor_plus", "coulomb_motor_minus")  # fmt: skip
        demand(min(d[name] for name in rest) >= 0, "a parameter of the drivetrain is negative")
        demand(d["contact"] in ("viscoelastic", "dead_zone"), "a contact law without a Lur'e form")
        one = Fraction(1)
        shaft = {"twist": k, "speed_motor": c, "speed_load": -c}
        if d["backlash"] > Fraction(1e-10):  # less counts as none
            lead = c / k if d["contact"] == "viscoelastic" else 0
            h = d["backlash"] / 2
            self.curves["gap"] = Curve([(-h, -HALF), (h, HALF)], Fraction(0), Fraction(0))
            self.arguments["gap"] = plus(
                (1, {"twist": one}), (lead, {"speed_motor": one, "speed_load": -one})
            )
            shaft = plus((1, shaft), (-k * d["backlash"], {"gap": one}))
        for place in ("motor", "load"):
            suffix = "_motor" if place == "motor" else ""
            up, down = d[f"coulomb{suffix}_plus"], d[f"coulomb{suffix}_minus"]
            if up or down:
                points = [(Fraction(0), -down / (up + down)), (Fraction(0), up / (up + down))]
                self.curves[f"friction_{place}"] = Curve(points, Fraction(0), Fraction(0))
                self.arguments[f"friction_{place}"] = {f"speed_{place}": one}
        drive = "torque_actuator" if d["lag"] else "torque_motor"
        level = d["coulomb_motor_plus"] + d["coulomb_motor_minus"], d["coulomb_plus"] + d["coulomb_minus"]
        motor = plus((1, {drive: one}), (-1, shaft), (-d["viscous_motor"], {"speed_motor": one}),
                     (-level[0], {"friction_motor": one}))  # fmt: skip
        load = plus((1, shaft), (-d["viscous"], {"speed_load": one}), (-level[1], {"friction_load": one}),
                    (1, {"torque_load": one}))  # fmt: skip
        self.rates["twist"] = {"speed_motor": one, "speed_load": -one}
        self.rates["speed_motor"], self.rates["speed_load"] = plus((1 / j1, motor)), plus((1 / j2, load))
        if d["lag"]:
            self.rates["torque_actuator"] = {"torque_motor": 1 / d["lag"], "torque_actuator": -1 / d["lag"]}
        return {
            **{name: {name: one} for name in ("twist", "speed_motor", "speed_load")},
            "torque_shaft": shaft,
        }

    def add_law(self, law, measured, delay, limit):
        """The law's rows with its inputs replaced by what they measure; the limit; the delay (3)."""
        given = {**measured, "speed_reference": {"speed_reference": Fraction(1)}}
        demand(set(law["inputs"]) <= set(given), "the law reads a signal that the plant does not give")
        inputs = [given[name] for name in law["inputs"]]
        # By number: a state's own name may be that of another one, of the delay say.
        states = [{f"law: {i}": Fraction(1)} for i in range(len(law["states"]))]
        values = []

        def row(by_state, by_input, by_curve):
            # Of the curves, a row reads those before it: the others stand there as zeros.
            return plus(
                *zip(by_state, states, strict=True),
                *zip(by_input, inputs, strict=True),
                *zip(by_curve, values),
            )

        def curve(argument, points, left, right):
            name = f"curve_{len(values)}"
            a, b, self.curves[name] = normalised(points, left, right)
            self.arguments[name] = argument
            values.append(plus((a, argument), (b, {name: Fraction(1)})))
            return values[-1]

        for i, content in enumerate(law["curves"]):
            demand(not any(law["H"][i][i:]), "an algebraic loop in the law")
            points = [(z, w) for z, w in content["points"]]
            argument = row(law["F"][i], law["G"][i], law["H"][i])
            curve(argument, points, content["slope_left"], content["slope_right"])
        self.limit = own_limit(law)
        torque = row(law["C"][0], law["D"][0], law["J"][0])
        after = [row(*rows) for rows in zip(law["A"], law["B"], law["E"], strict=True)]
        if limit is not None and not (self.limit and within(law["curves"][int(self.limit[6:])], limit)):
            demand(limit > 0, "a torque limit that is not positive")
            self.limit = f"curve_{len(values)}"
            torque = curve(torque, [(-limit, -limit), (limit, limit)], Fraction(0), Fraction(0))
        line = [f"law: torque_motor_{i + 1}" for i in range(delay)]
        held = [torque, *({name: Fraction(1)} for name in line)]
        self.jump["torque_motor"] = held[-1]
        self.jump.update({f"law: {i}": form for i, form in enumerate(after)})
        self.jump.update(zip(line, held))


def own_limit(law):
    """The curve that bounds the law's torque and never falls: the torque is its value and nothing else."""
    used = [i for i, value in enumerate(law["J"][0]) if value]
    if any(law["C"][0]) or any(law["D"][0]) or len(used) != 1 or law["J"][0][used[0]] != 1:
        return None
    content = law["curves"][used[0]]
    values = [w for _, w in content["points"]]
    if content["slope_left"] or content["slope_right"] or values != sorted(values):
        return None
    return f"curve_{used[0]}"


def within(content, limit):
    return all(abs(w) <= limit for _, w in content["points"])


def pruned(law):
    """The law with what its torque reads alone."""
    size = {
        "x": len(law["states"]),
        "u": len(law["inputs"]),
        "w": len(law["curves"]),
        "y": len(law["outputs"]),
    }
    for key, (rows, columns) in SHAPES.items():
        fits = len(law[key]) == size[rows] and all(len(row) == size[columns] for row in law[key])
        demand(fits, f"the law's matrix {key} has another shape")
    torque = law["outputs"].index("torque_motor")
    x = {i for i, v in enumerate(law["C"][torque]) if v}
    w = {i for i, v in enumerate(law["J"][torque]) if v}
    count = -1
    while count != len(x) + len(w):
        count = len(x) + len(w)
        for key, reading, read in (("A", x, x), ("E", x, w), ("F", w, x), ("H", w, w)):
            read |= {i for j in list(reading) for i, v in enumerate(law[key][j]) if v}
    x, w = sorted(x), sorted(w)
    pick = lambda rows, i, j: [[rows[a][b] for b in j] for a in i]  # noqa: E731
    u = range(len(law["inputs"]))
    return {
        "inputs": law["inputs"], "states": [law["states"][i] for i in x], "curves": [law["curves"][i] for i in w],
        "A": pick(law["A"], x, x), "B": pick(law["B"], x, u), "E": pick(law["E"], x, w),
        "F": pick(law["F"], w, x), "G": pick(law["G"], w, u), "H": pick(law["H"], w, w),
        "C": pick(law["C"], [torque], x), "D": pick(law["D"], [torque], u), "J": pick(law["J"], [torque], w),
    }  # fmt: skip


# --- equilibria, sectors and copies -------------------------------------------------------------------------------


def equilibrium(loop, segments, speed, torque_load):
    """Arguments of all curves, and states, with the loop at rest: every curve continued along its segment (4), then
    checked (5)."""
    lines = {}
    for name, segment in zip(loop.curves, segments, strict=True):
        value, slope = loop.curves[name].line(segment)
        lines[name] = plus((1, {"1": value}), (slope, loop.arguments[name]))
    one = Fraction(1)
    equations = [replaced(form, {"torque_load": {"1": torque_load}}) for form in loop.rates.values()]
    equations += [minus(form, {name: one}) for name, form in loop.jump.items()]
    equations += [minus(form, {name: one}) for name, form in lines.items()]
    equations.append(plus((1, {"speed_load": one}), (-speed, {"1": one})))
    found = solve(equations, [*loop.states, *loop.curves, "speed_reference"])
    arguments = {}
    for name, segment in zip(loop.curves, segments, strict=True):
        arguments[name] = sum(value * found[key] for key, value in loop.arguments[name].items())
        demand(loop.curves[name].segment(arguments[name]) == segment, f"{name} rests on another segment")
    return arguments, {name: found[name] for name in loop.states}


def sectors_of(loop, corners):
    """Sector of each curve for all equilibria between the corners (6, 7)."""
    found = {}
    for name, curve in loop.curves.items():
        each = [curve.sector(corner[name]) for corner in corners]
        found[name] = min(low for low, _ in each), max(high for _, high in each)
    return found


def copies_of(loop, corners):
    """(slope, slack, loss) of all pairs of arguments of one rising curve (8, 9); of a jump slope and slack are 1."""
    found = {}
    for a, b in combinations(loop.curves, 2):
        curve = loop.curves[a]
        if curve.key != loop.curves[b].key or not curve.rises or curve.steepest == 0:
            continue
        slope, slack, loss = curve.steepest or Fraction(1), Fraction(0), Fraction(0)
        if any(corner[a] != corner[b] for corner in corners):
            segments = {curve.segment(corner[name]) for corner in corners for name in (a, b)}
            if len(segments) != 1 or curve.slopes[segments.pop()] != 0:
                continue
            apart = max(
                abs(corner[a] - corner[b]) / abs(corner[name] - z)
                for corner in corners
                for name in (a, b)
                for z, _ in curve.points
            )
            slack = min(Fraction(1, 4), 64 * apart)
            loss = (slope * apart) ** 2 / (4 * slack)
        found[a, b] = slope, slack + (curve.steepest is None), loss
    return found


# --- the proof ----------------------------------------------------------------------------------------------------


def moving_curves(loop):
    """Law curves whose argument hangs on more than the set-point; the others stand still at a set-point."""
    moving = []
    for name in loop.law_curves:
        still = {"speed_reference", *(c for c in loop.law_curves if c not in moving)}
        if set(loop.arguments[name]) - still:
            moving.append(name)
    return moving


class Proof:
    """The inequalities (12), (13) and (15), with P and multipliers taken from the certificate in their order.

    With a region, also (17) and (18).
    """

    def __init__(self, loop, sectors, copies, dt, proof, region):
        self.loop, self.sectors, self.copies, self.dt, self.region = loop, sectors, copies, dt, region
        if region is not None:  # (17) asks what a limit that does not act would do: that has no copies
            self.copies = {pair: known for pair, known in copies.items() if loop.limit not in pair}
        demand(set(proof) <= NUMBERS, "the certificate was written by another version: prove it again")
        self.substeps = whole(proof["substeps"], 1)
        self.moving = moving_curves(loop)
        self.of_state = self.curves_of_the_state()
        self.zeta = [*loop.states, *self.of_state]
        self.p = [self.symmetric(m) for m in proof["P"]]
        demand(len(self.p) == self.substeps + 1, "not as many matrices P as knots")
        self.multipliers = {name: list(values) for name, values in proof["multipliers"].items()}
        demand(
            all(m >= 0 for values in self.multipliers.values() for m in values), "a multiplier is negative"
        )
        self.eta = self.signed("eta", loop.plant_curves)
        self.theta = self.signed("theta", self.of_state)

    def curves_of_the_state(self):
        """Rising law curves without a jump whose argument is the law's state alone: the integrals of V (10)."""
        found, states = [], {s for s in self.loop.states if s.startswith("law: ")}
        for name in self.moving:
            curve = self.loop.curves[name]
            reads_state_alone = set(self.deviation(self.loop.arguments[name])) <= states | set(found)
            if (
                reads_state_alone
                and curve.rises
                and curve.steepest
                and not (self.region and name == self.loop.limit)
            ):
                found.append(name)
        return found

    def deviation(self, form):
        """The form without what stands still at an equilibrium."""
        still = {"speed_reference", "torque_load"} | (set(self.loop.law_curves) - set(self.moving))
        return {name: value for name, value in form.items() if name not in still}

    def symmetric(self, rows):
        size = len(self.zeta)
        demand(len(rows) == size and all(len(row) == size for row in rows), "a matrix P of another size")
        demand(all(rows[i][j] == rows[j][i] for i in range(size) for j in range(i)), "P is not symmetric")
        return rows

    def signed(self, name, curves):
        """Weights of the integrals, as (positive part, negative part)."""
        parts = self.multipliers[f"{name}_plus"], self.multipliers[f"{name}_minus"]
        return dict(zip(curves, zip(*parts, strict=True), strict=True))

    def quadratic(self, p, forms):
        """formsᵀ p forms."""
        total = {}
        for row, a in zip(p, forms, strict=True):
            add_product(total, 1, a, plus(*zip(row, forms, strict=True)))
        return total

    def subtract_known(self, total, where, curves):
        """Takes what is known of curves to be ≥ 0 times its multipliers off: sectors (7), then copies (8, 9).

        ``curves``: (curve's name, form of its argument, form of its value).
        """
        factors = self.multipliers[where]
        pairs = list(self.pairs(curves))
        demand(len(factors) == len(curves) + len(pairs), f"{where}: not as many multipliers as conditions")
        for factor, (name, z, w) in zip(factors, curves):
            low, high = self.sectors[name]
            add_product(total, -2 * factor, plus((1, w), (-low, z)), plus((high, z), (-1, w)))
        for factor, (slope, slack, loss, (_, z1, w1), (_, z2, w2)) in zip(factors[len(curves) :], pairs):
            rise, apart = minus(w1, w2), minus(z1, z2)
            add_product(total, -2 * factor, rise, plus((slope, apart), (slack - 1, rise)))
            add_product(total, -2 * factor * loss, z1, z1)
            add_product(total, -2 * factor * loss, z2, z2)
        return total

    def pairs(self, curves):
        for a, b in combinations(curves, 2):
            known = self.copies.get((a[0], b[0])) or self.copies.get((b[0], a[0]))
            if a[0] == b[0]:
                known = self.loop.curves[a[0]].steepest, Fraction(0), Fraction(0)
            if known:
                yield (*known, a, b)

    def own(self, name):
        return {name: Fraction(1)}

    def evaluated(self, names, by=None):
        """(name, argument, value) of curves, with states and values replaced."""
        by = by or {}
        return [
            (name, replaced(self.deviation(self.loop.arguments[name]), by), by.get(name, self.own(name)))
            for name in names
        ]

    def least(self, k):
        """V at knot k, with the largest value of each integral that it subtracts (11)."""
        total = self.quadratic(self.p[k], [self.own(name) for name in self.zeta])
        for weights in (self.eta, self.theta):
            for name, (_, negative) in weights.items():
                z = self.deviation(self.loop.arguments[name])
                add_product(total, -negative * self.sectors[name][1], z, z)
        return total

    def contains(self):
        """(17): V before a sample is at least level · (the limit's argument)²."""
        total = self.least(self.substeps)
        s = self.deviation(self.loop.arguments[self.loop.limit])
        add_product(total, -self.level(), s, s)
        seen = self.seen()
        self.subtract_known(total, "region", self.evaluated([*seen, *self.moving]))
        return positive_definite(total, [*self.loop.states, *seen, *self.moving])

    def starts_inside(self):
        """(18): V after the largest step, with every curve on its flat segment, is within the level."""
        start = [self.region["start"].get(name, Fraction(0)) for name in self.zeta]
        v = sum(a * b * value for a, row in zip(start, self.p[-1]) for b, value in zip(start, row))
        return v < self.level() * self.region["reach"] ** 2

    def level(self):
        (level,) = self.multipliers["level"]
        return level

    def positive(self, k):
        """(12): what V at knot k is at least, is positive."""
        total = self.least(k)
        self.subtract_known(total, f"rest_{k}", self.evaluated(self.of_state))
        return positive_definite(total, self.zeta)

    def falls(self, k, end):
        """(13): −dV/dτ at one end of substep k, times the length of the substep."""
        step = self.dt / self.substeps
        rates = {name: plus((step, self.deviation(form))) for name, form in self.loop.rates.items()}
        rate = [rates.get(name, {}) for name in self.zeta]
        here = [self.own(name) for name in self.zeta]
        total = {}
        for i, row in enumerate(self.p[k + end]):
            add_product(total, -2, rate[i], dict(zip(self.zeta, row)))
        change = [[a - b for a, b in zip(*rows)] for rows in zip(self.p[k], self.p[k + 1])]
        for key, value in self.quadratic(change, here).items():
            total[key] = total.get(key, 0) + value
        for name, (positive, negative) in self.eta.items():
            z_rate = replaced(self.loop.arguments[name], rates)
            add_product(total, -2 * (positive - negative), self.own(name), z_rate)
        curves = self.evaluated([*self.loop.plant_curves, *self.of_state])
        self.subtract_known(total, f"flow_{k}_{end}", curves)
        return positive_definite(total, [*self.zeta, *self.loop.plant_curves])

    def does_not_rise(self):
        """(15): V before minus V after a sample, with the bounds (14) on what the integrals change."""
        loop, one = self.loop, Fraction(1)
        by = {name: self.deviation(form) for name, form in loop.jump.items()}
        by |= {name: {f"{name} after": one} for name in self.of_state}
        before = [self.own(name) for name in self.zeta]
        after = [by.get(name, self.own(name)) for name in self.zeta]
        total = self.quadratic(self.p[-1], before)
        for key, value in self.quadratic(self.p[0], after).items():
            total[key] = total.get(key, 0) - value
        seen = self.seen()
        now, later = self.evaluated([*seen, *self.moving]), self.evaluated(self.of_state, by)
        for (name, z1, w1), (_, z0, w0) in zip(later, self.evaluated(self.of_state)):
            positive, negative = self.theta[name]
            step, rise = minus(z1, z0), minus(w1, w0)
            add_product(total, -2 * positive, w1, step)
            add_product(total, 2 * negative, w0, step)
            add_product(total, (positive + negative) / loop.curves[name].steepest, rise, rise)
        self.subtract_known(total, "jump", now + later)
        return positive_definite(
            total, [*loop.states, *seen, *self.moving, *(f"{n} after" for n in self.of_state)]
        )

    def holds(self):
        """All inequalities of a sampled loop."""
        for k in range(self.substeps + 1):
            demand(self.positive(k), f"V is not positive at knot {k} (12)")
        for k in range(self.substeps):
            for end in (0, 1):
                demand(self.falls(k, end), f"V does not fall in substep {k}, end {end} (13)")
        demand(self.does_not_rise(), "V rises at a sample (15)")
        if self.region is not None:
            demand(self.loop.limit in self.moving, "the torque limit reads nothing")
            demand(self.contains(), "the level does not keep the torque in its region (17)")
            demand(self.starts_inside(), "the step starts above the level (18)")

    def holds_in_continuous_time(self):
        """All inequalities of a loop without samples: one P, given twice."""
        demand(
            self.substeps == 1 and self.p[0] == self.p[1],
            "P changes although the law acts in continuous time",
        )
        demand(self.positive(0), "V is not positive (12)")
        demand(self.falls(0, 0), "V does not fall (13)")

    def seen(self):
        """Plant curves that the law reads at a sample, or has copies of."""
        forms = [*self.loop.jump.values(), *(self.loop.arguments[name] for name in self.moving)]
        read = {name for form in forms for name in form}
        read |= {name for pair in self.copies for name in pair if set(pair) & set(self.moving)}
        return [name for name in self.loop.plant_curves if name in read]


def verify(certificate, law=None):
    """The claim that is proved; raises ``NotProved``."""
    demand(certificate["claim"] is not None, "the file claims nothing")
    claim, own = certificate["claim"], certificate["law"]
    demand(set(claim) == CLAIM | ({"box"} if "cells" in certificate else set()), "a claim of another kind")
    if law is not None:
        demand(pruned(law) == pruned(own) and law["dt"] == own["dt"], "the certificate is about another law")
    if "cells" in certificate:
        return verify_box(certificate)
    demand(own["dt"] > 0, "a sample time that is not positive")
    memory = certificate["proof"].get("memory", ())
    loop = Loop(certificate["drivetrain"], pruned(own), whole(certificate["delay"], 0), memory)
    segments = [whole(segment, 0) for segment in certificate["segments"]]
    ends = ends_of(claim, loop)
    rests = [equilibrium(loop, segments, r, m) for r, m in ends]
    corners = [arguments for arguments, _ in rests]
    sectors = sectors_of(loop, corners)
    region = None
    if claim["limit"] is not None:
        region = region_of(loop, claim, sectors, rests, ends)
    proof = Proof(loop, sectors, copies_of(loop, corners), own["dt"], certificate["proof"], region)
    proof.holds()
    return claim


def ends_of(claim, loop):
    """Corners of the ranges of load speed and load torque."""
    speeds, torques = (claim["speed_from"], claim["speed_to"]), claim["torque_load"]
    demand(
        len(torques) == 2 and 0 < speeds[0] <= speeds[1] and torques[0] <= torques[1],
        "no ranges in the claim",
    )
    if claim["both_directions"]:
        demand(all(c.key == mirrored(c) for c in loop.curves.values()), "the two directions differ")
    return [(r, m) for r in sorted(set(speeds)) for m in sorted(set(torques))]


def region_of(loop, claim, sectors, rests, ends):
    """Where the limit's sector is [share · slope, slope]: within reach of its argument (16). Changes the sector."""
    step, share = claim["limit"]["step"], claim["limit"]["share"]
    demand(loop.limit is not None, "there is no torque limit")
    demand(step > 0 and 0 < share <= 1, "no step or no share in the claim")
    curve = loop.curves[loop.limit]
    high, moving = sectors[loop.limit][1], {*loop.plant_curves, *moving_curves(loop)}
    for arguments, _ in rests:
        for name, other in loop.curves.items():
            slope = other.line(other.segment(arguments[name]))[1]
            demand(slope == (high if name == loop.limit else slope), "the limit acts at rest")
            # Then no curve but the limit changes its value from one rest to the other, and every integral is zero.
            demand(slope == 0 or name == loop.limit or name not in moving, f"{name} rests on a slope")
    room = min(abs(arguments[loop.limit] - z) for arguments, _ in rests for z, _ in curve.points)
    sectors[loop.limit] = share * high, high
    lowest, highest = (
        ends.index((claim["speed_from"], ends[0][1])),
        ends.index((claim["speed_to"], ends[0][1])),
    )
    span = claim["speed_to"] - claim["speed_from"]
    demand(span > 0, "the claim has no room for a step")
    low, high = rests[lowest][1], rests[highest][1]
    start = {name: (high[name] - low[name]) / span * step for name in low}
    return {"reach": room / share, "start": start}


def mirrored(curve):
    """The key of −w(−z)."""
    return tuple((-z, -w) for z, w in reversed(curve.points)), curve.right, curve.left


# --- a box of drivetrains, and laws in continuous time ------------------------------------------------------------

#: Parameters that a box may vary, and the names in the drivetrain that they multiply.
BOX = {
    "inertia_motor": ["inertia_motor"], "inertia_load": ["inertia_load"], "stiffness": ["stiffness"],
    "backlash": ["backlash"],
    "coulomb": ["coulomb_plus", "coulomb_minus", "coulomb_motor_plus", "coulomb_motor_minus"],
}  # fmt: skip

#: What enters the flow, and the place (layout) of the one state whose rate it multiplies: k·twist, speeds (24).
IN_THE_FLOW = {"stiffness": 0, "inertia_load": 2, "inertia_motor": 1}

#: Unit of time of the multipliers for a law in continuous time, s (numerics).
TIME_UNIT = Fraction(1, 1024)


class ContinuousLoop(Loop):
    """A law in continuous time: its rows give rates, and its torque acts at once (23)."""

    def __init__(self, drivetrain, law):
        super().__init__(drivetrain, law, 0)
        by = {"torque_motor": self.jump.pop("torque_motor")}
        self.rates = {name: replaced(form, by) for name, form in {**self.rates, **self.jump}.items()}
        self.jump, self.states, self.plant_curves, self.law_curves = (
            {},
            list(self.rates),
            list(self.curves),
            [],
        )
        for form in self.arguments.values():
            demand(set(form) <= set(self.states), "a curve reads more than states")


def verify_box(certificate):
    """The claim for every drivetrain of the box: cell by cell. A cut leaves nothing between its two sides."""
    box = {name: tuple(ends) for name, ends in certificate["claim"]["box"].items()}
    demand(set(box) <= set(BOX), "a parameter that a box cannot vary")
    demand(all(len(ends) == 2 and 0 < ends[0] <= ends[1] for ends in box.values()), "a box without room")
    open_cells = [(certificate["cells"], box)]
    while open_cells:
        node, cell = open_cells.pop()
        if "cut" not in node:
            verify_cell(certificate, node["proof"], cell)
            continue
        low, high = cell[node["cut"]]
        demand(low < node["at"] < high, "a cut outside of its cell")
        open_cells.append((node["below"], {**cell, node["cut"]: (low, node["at"])}))
        open_cells.append((node["above"], {**cell, node["cut"]: (node["at"], high)}))
    return certificate["claim"]


def verify_cell(certificate, numbers, cell):
    """One P and one set of integrals for every drivetrain of the cell (24 to 26)."""
    claim, law = certificate["claim"], certificate["law"]
    segments, sampled = [whole(segment, 0) for segment in certificate["segments"]], law["dt"] > 0
    # Sectors: friction's ends with the largest stiffness and backlash (26).
    widest = {name: cell[name][1:] for name in ("stiffness", "backlash") if name in cell}
    at_rest = [loop_at(certificate, c, cell) for c in corners_of({**cell, **widest}, ("coulomb", *widest))]
    # Neither what the law reads nor where it rests may hang on stiffness and backlash.
    demand(not cell or "twist" not in law["inputs"], "the law reads the twist, which is no torque")
    loop, ends = at_rest[0], ends_of(claim, at_rest[0])
    rests = [[equilibrium(each, segments, r, m) for r, m in ends] for each in at_rest]
    each = [sectors_of(one, [arguments for arguments, _ in found]) for one, found in zip(at_rest, rests)]
    sectors = {n: (min(s[n][0] for s in each), max(s[n][1] for s in each)) for n in loop.curves}
    rests = [rest for found in rests for rest in found]
    copies = copies_of(loop, [arguments for arguments, _ in rests])
    if cell:  # the gap of the drivetrain is not the law's
        copies = {pair: c for pair, c in copies.items() if all(name.startswith("curve_") for name in pair)}
    region = None
    if claim["limit"] is not None:
        demand(sampled, "a torque limit with a law in continuous time")
        region = region_of(loop, claim, sectors, rests, ends)
    corners = corners_of(cell, IN_THE_FLOW)
    demand(len(numbers) == len(corners), "not as many proofs as corners of a cell")
    proofs = []
    for corner, own in zip(corners, numbers):
        each = loop_at(certificate, corner, cell)
        demand(
            each.jump == loop.jump and each.arguments == loop.arguments, "the law reads what the box varies"
        )
        proofs.append(Proof(each, sectors, copies, law["dt"] if sampled else TIME_UNIT, own, region))
        if sampled:
            proofs[-1].holds()
        else:
            proofs[-1].holds_in_continuous_time()
    for a, b in combinations(range(len(corners)), 2):
        differ = [name for name in corners[a] if corners[a][name] != corners[b][name]]
        demand(proofs[a].eta == proofs[b].eta, "integrals of the plant differ within a cell")
        for p, q in zip(proofs[a].p, proofs[b].p):
            same = len(differ) > 1 or p[IN_THE_FLOW[differ[0]]] == q[IN_THE_FLOW[differ[0]]]
            demand(same, "P is not multi-affine in a cell")


def corners_of(cell, names):
    """Every combination of the smallest and largest shares of the named parameters."""
    found = [{}]
    for name in names:
        found = [
            {**c, name: share} for c in found for share in sorted(set(cell.get(name, ()))) or [Fraction(1)]
        ]
    return found


def loop_at(certificate, shares, cell):
    """The loop of a drivetrain in the cell; with the shaft's torques in Nm, unless there is no box (24)."""
    d, law = dict(certificate["drivetrain"]), pruned(certificate["law"])
    for name, share in shares.items():
        for parameter in BOX[name]:
            d[parameter] *= share
    if certificate["law"]["dt"] > 0:
        loop = Loop(d, law, whole(certificate["delay"], 0))
    else:
        demand(certificate["law"]["dt"] == 0 and certificate["delay"] == 0, "a law in no time")
        demand(d["torque_limit"] is None, "a torque limit with a law in continuous time")
        loop = ContinuousLoop(d, law)
    if cell:
        in_torque(loop, d)
    return loop


def in_torque(loop, d):
    """Takes stiffness · twist for the twist, and Nm for the plant's curves and the gap's argument (24)."""
    k = d["stiffness"]
    heights = {
        "gap": k * d["backlash"],
        "friction_motor": d["coulomb_motor_plus"] + d["coulomb_motor_minus"],
        "friction_load": d["coulomb_plus"] + d["coulomb_minus"],
    }
    by = {"twist": {"twist": 1 / k}}
    for name in set(heights) & set(loop.curves):
        height, width, curve = heights[name], k if name == "gap" else Fraction(1), loop.curves[name]
        by[name] = {name: 1 / height}
        points = [(width * z, height * w) for z, w in curve.points]
        loop.curves[name] = Curve(points, curve.left * height / width, curve.right * height / width)
    for forms in (loop.rates, loop.jump, loop.arguments):
        forms.update({name: replaced(form, by) for name, form in forms.items()})
    loop.rates["twist"] = plus((k, loop.rates["twist"]))
    if "gap" in loop.arguments:
        loop.arguments["gap"] = plus((k, loop.arguments["gap"]))


def read(path):
    with open(path, encoding="utf-8") as file:  # noqa: PTH123 (a script without further imports)
        return parsed(file.read())


def parsed(text):
    """JSON in exact fractions: the number that each decimal means as a float."""
    return json.loads(
        text, parse_float=lambda digits: Fraction(float(digits)), parse_int=Fraction, parse_constant=refused
    )


def refused(text):
    raise NotProved(f"{text} is no number")


def main(paths):
    if len(paths) not in (1, 2):
        print(__doc__)
        return 2
    try:
        claim = verify(*map(read, paths))
    except NotProved as reason:
        print(f"NOT PROVED: {reason}")
        return 1
    except (OSError, *NO_CERTIFICATE) as error:
        print(f"NOT PROVED: the file is no certificate ({type(error).__name__}: {error})")
        return 1
    for name, ends in claim.get("box", {}).items():
        print("For {} times {!r} to {!r},".format(name, *map(float, ends)))
    low, high = float(claim["speed_from"]), float(claim["speed_to"])
    print(f"PROVED: asymptotically stable at every load speed from {low!r} to {high!r} rad/s,")
    print("        in both directions," if claim["both_directions"] else "        in the positive direction,")
    print("        load torque {!r} to {!r} Nm,".format(*map(float, claim["torque_load"])), end=" ")
    if claim["limit"] is None:
        print("from every state")
    else:
        print(
            f"after every step of the load speed by up to {float(claim['limit']['step'])!r} rad/s between them"
        )
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
