#!/usr/bin/env python3
"""Checks a stability certificate in exact fractions: python verify_certificate.py certificate.json [law.json]

It needs Python's standard library alone. Drivetrain and law are what the claim is about; all else that it takes from
the file, P and multipliers, either satisfies the inequalities or does not. With law.json it compares the law with that.
Exit code 0: proved; 1: not proved. Numbers in brackets are the equations of docs/proofs.md.

    step                                                      where                              equations
    1  read decimals as exact fractions                       read, parsed
    2  the claim, and the law that it is about                verify, pruned
    3  build the loop from drivetrain and law                 Loop                               (1) to (3), (27)
    4  find its rests, and the curves' sectors and copies     equilibrium, sectors_of, copies_of (4) to (9)
    5  sizes and signs of P and the multipliers               Proof.__init__
    6  V is positive, falls, and does not rise at a sample    Proof.holds                        (10) to (15)
    7  where the torque limit acts: V keeps it in a region    region_of, Proof.keeps_the_region  (16) to (18)
    8  for a box of drivetrains: 3 to 7 for each of its cells verify_cells, verify_cell          (23) to (26)

The names "1", "speed_reference" and "torque_load" in forms stand for the constant and the loop's inputs.
"""

import json
import sys
from fractions import Fraction
from itertools import combinations

#: Numerics.
ONE, HALF, NOTHING = Fraction(1), Fraction(1, 2), Fraction(0)

#: Bits behind the point in the test for positive definiteness (numerics): the margins of proofs are above 2^-40.
BITS = 96

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


# --- the claim --------------------------------------------------------------------------------------------------------

#: Parameters that a box may vary: all in the drivetrain that begin so.
BOX = {"inertia_motor", "inertia_load", "stiffness", "backlash", "coulomb"}

#: Those that enter the flow, and the place (layout) of the one state whose rate they multiply: k·twist, speeds (24).
IN_THE_FLOW = {"stiffness": 0, "inertia_load": 2, "inertia_motor": 1}

#: Unit of time of the multipliers for a law in continuous time, s (numerics).
TIME_UNIT = Fraction(1, 1024)


def verify(certificate, law=None):
    """The claim that is proved; raises ``NotProved``."""
    claim, is_box = certificate["claim"], "cells" in certificate
    demand(claim is not None, "the file claims nothing")
    own = certificate["law"]
    demand(set(claim) == CLAIM | ({"box"} if is_box else set()), "a claim of another kind")
    demand(law is None or pruned(law) == pruned(own), "the certificate is about another law")
    if is_box:
        box = {name: tuple(ends) for name, ends in claim["box"].items()}
        demand(set(box) <= BOX, "a parameter that a box cannot vary")
        demand(all(len(ends) == 2 and 0 < ends[0] <= ends[1] for ends in box.values()), "a box without room")
        verify_cells(certificate, certificate["cells"], box)
    else:
        demand(own["dt"] > 0, "a sample time that is not positive")
        verify_cell(certificate, [certificate["proof"]], {})
    return claim


def verify_cells(certificate, node, cell):
    """A tree of cuts: a cut leaves nothing between its two sides."""
    if "cut" not in node:
        verify_cell(certificate, node["proof"], cell)
        return
    (low, high), at = cell[node["cut"]], node["at"]
    demand(low < at < high, "a cut outside of its cell")
    for side, ends in (("below", (low, at)), ("above", (at, high))):
        verify_cells(certificate, node[side], {**cell, node["cut"]: ends})


def verify_cell(certificate, numbers, cell):
    """A proof at each corner of the cell, for all drivetrains in it (24 to 26); an empty cell is one drivetrain."""
    claim, law = certificate["claim"], certificate["law"]
    demand(not cell or "twist" not in law["inputs"], "the law reads the twist, which is no torque")
    memory = numbers[0].get("memory", ()) if not cell else ()
    # The sectors are widest with the largest stiffness and backlash, and at both ends of friction (26).
    widest = {name: cell[name][1:] for name in ("stiffness", "backlash") if name in cell}
    at_rest = corners_of({**cell, **widest}, ("coulomb", *widest))
    loops = [loop_at(certificate, corner, cell, memory) for corner in at_rest]
    loop, ends = loops[0], ends_of(claim, loops[0])
    segments = [whole(segment, 0) for segment in certificate["segments"]]
    rests = [[equilibrium(each, segments, r, m) for r, m in ends] for each in loops]
    sectors, rests = sectors_of(loops, rests), [rest for own in rests for rest in own]
    copies = copies_of(loop, rests)
    if cell:  # the gap of the drivetrain is not the law's
        copies = {pair: c for pair, c in copies.items() if all(name.startswith("curve_") for name in pair)}
    region = None if claim["limit"] is None else region_of(loop, claim, sectors, rests, ends)
    corners = corners_of(cell, IN_THE_FLOW)
    demand(len(numbers) == len(corners), "not as many proofs as corners of a cell")
    proofs = []
    for corner, own in zip(corners, numbers):
        each = loop_at(certificate, corner, cell, memory)
        same = each.jump == loop.jump and each.arguments == loop.arguments
        demand(same, "the law reads what the box varies")
        proofs.append(Proof(each, sectors, copies, law["dt"] or TIME_UNIT, own, region))
        proofs[-1].holds()
    for a, b in combinations(range(len(corners)), 2):
        differ = [name for name in corners[a] if corners[a][name] != corners[b][name]]
        demand(proofs[a].eta == proofs[b].eta, "integrals of the plant differ within a cell")
        for p, q in zip(proofs[a].p, proofs[b].p):
            same = len(differ) > 1 or p[IN_THE_FLOW[differ[0]]] == q[IN_THE_FLOW[differ[0]]]
            demand(same, "P is not multi-affine in a cell (25)")


def corners_of(cell, names):
    """Every combination of the smallest and largest shares of the named parameters."""
    found = [{}]
    for name in names:
        shares = sorted(set(cell.get(name, (ONE,))))
        found = [{**corner, name: share} for corner in found for share in shares]
    return found


def loop_at(certificate, shares, cell, memory):
    """The loop of a drivetrain in the cell; with the shaft's torques in Nm, unless there is no box (24)."""
    d, law = dict(certificate["drivetrain"]), pruned(certificate["law"])
    for name, share in shares.items():
        d |= {parameter: share * value for parameter, value in d.items() if parameter.startswith(name)}
    delay = whole(certificate["delay"], 0)
    if law["dt"] <= 0:
        demand(law["dt"] == 0 and delay == 0, "a law in no time")
        demand(d["torque_limit"] is None, "a torque limit with a law in continuous time")
    return Loop(d, law, delay, memory, in_torque=bool(cell))


# --- the loop ---------------------------------------------------------------------------------------------------------

#: Rows and columns of the law's matrices: states, inputs, curves, outputs.
SHAPES = {"A": "xx", "B": "xu", "E": "xw", "F": "wx", "G": "wu", "H": "ww", "C": "yx", "D": "yu", "J": "yw"}


def pruned(law):
    """The law with what its torque reads alone."""
    lists = {"x": law["states"], "u": law["inputs"], "w": law["curves"], "y": law["outputs"]}
    for key, (rows, columns) in SHAPES.items():
        fits = len(law[key]) == len(lists[rows]) and all(len(row) == len(lists[columns]) for row in law[key])
        demand(fits, f"the law's matrix {key} has another shape")
    torque = law["outputs"].index("torque_motor")
    kept = {"x": set(), "w": set(), "u": range(len(law["inputs"])), "y": [torque]}
    count = -1
    while count != len(kept["x"]) + len(kept["w"]):
        count = len(kept["x"]) + len(kept["w"])
        for key in "CJAEFH":
            reading, read = SHAPES[key]
            kept[read] |= {i for j in list(kept[reading]) for i, value in enumerate(law[key][j]) if value}
    kept = {kind: sorted(places) for kind, places in kept.items()}
    found = {key: [[law[key][i][j] for j in kept[c]] for i in kept[r]] for key, (r, c) in SHAPES.items()}
    found |= {name: [lists[kind][i] for i in kept[kind]] for name, kind in (("states", "x"), ("curves", "w"))}
    return {**found, "inputs": law["inputs"], "dt": law["dt"]}


def own_limit(law):
    """Number of the curve that bounds a pruned law's torque and never falls: the torque is its value and nothing else;
    None if there is none."""
    used = [i for i, value in enumerate(law["J"][0]) if value]
    if any(law["C"][0]) or any(law["D"][0]) or len(used) != 1 or law["J"][0][used[0]] != 1:
        return None
    content = law["curves"][used[0]]
    values = [w for _, w in content["points"]]
    flat = content["slope_left"] == content["slope_right"] == 0
    return used[0] if flat and values == sorted(values) else None


class Loop:
    """Forms of the loop: rates (1), values after a sample (3), and the curves with their arguments (2)."""

    def __init__(self, drivetrain, law, delay, memory, in_torque):
        self.rates, self.jump, self.arguments, self.curves = {}, {}, {}, {}
        measured = self.add_plant(drivetrain, in_torque)
        self.plant_curves = list(self.curves)
        self.add_law(law, measured, delay, drivetrain["torque_limit"])
        self.add_memory(memory)
        if not law["dt"]:
            self.make_continuous()
        self.states = [*self.rates, *self.jump]
        self.law_curves = [name for name in self.curves if name not in self.plant_curves]
        #: Law curves whose argument hangs on more than the set-point; the others stand still at a set-point.
        self.moving = []
        self.still = {"speed_reference", "torque_load", *self.law_curves}
        for name in self.law_curves:
            if set(self.arguments[name]) - self.still:
                self.moving.append(name)
                self.still.remove(name)

    def add_curve(self, name, curve, argument):
        self.curves[name], self.arguments[name] = curve, argument
        return var(name)

    def add_plant(self, d, in_torque):
        """Two inertias, a shaft with backlash, friction, the actuator's lag (1); returns what a law can measure.

        in_torque: the state "twist" is stiffness · twist, and gap and friction have their values in Nm (24).
        """
        k, c = d["stiffness"], d["damping"]
        rest = ("damping", "backlash", "viscous", "viscous_motor", "lag", "coulomb_plus", "coulomb_minus",
                "coulomb_motor_plus", "coulomb_motor_minus")  # fmt: skip
        demand(min(k, d["inertia_motor"], d["inertia_load"]) > 0, "an inertia or stiffness is not positive")
        demand(min(d[name] for name in rest) >= 0, "a parameter of the drivetrain is negative")
        demand(d["contact"] in ("viscoelastic", "dead_zone"), "a contact law without a Lur'e form")
        unit = k if in_torque else ONE
        twist, motor, load = 1 / unit * var("twist"), var("speed_motor"), var("speed_load")

        def torque_of(name, height, points, argument):
            """A curve that changes by ``height`` in Nm, from points of a curve of height 1."""
            own = height if in_torque else ONE
            return height / own * self.add_curve(name, Curve([(z, own * w) for z, w in points]), argument)

        shaft = k * twist + c * (motor - load)
        if d["backlash"] > Fraction(1e-10):  # less counts as none
            h, lead = unit * d["backlash"] / 2, (c / k if d["contact"] == "viscoelastic" else 0)
            argument = unit * (twist + lead * (motor - load))
            shaft -= torque_of("gap", k * d["backlash"], [(-h, -HALF), (h, HALF)], argument)
        drive = var("torque_actuator" if d["lag"] else "torque_motor")
        self.rates["twist"] = unit * (motor - load)
        ends = ("motor", "_motor", motor, drive - shaft), ("load", "", load, shaft + var("torque_load"))
        for place, suffix, speed, torque in ends:
            up, down = d[f"coulomb{suffix}_plus"], d[f"coulomb{suffix}_minus"]
            torque -= d[f"viscous{suffix}"] * speed
            if up or down:
                points = [(NOTHING, -down / (up + down)), (NOTHING, up / (up + down))]
                torque -= torque_of(f"friction_{place}", up + down, points, speed)
            self.rates[f"speed_{place}"] = 1 / d[f"inertia_{place}"] * torque
        if d["lag"]:
            self.rates["torque_actuator"] = 1 / d["lag"] * (var("torque_motor") - drive)
        return {"twist": twist, "speed_motor": motor, "speed_load": load, "torque_shaft": shaft}

    def add_law(self, law, measured, delay, limit):
        """The law's rows with its inputs replaced by what they measure; the drive's limit; the delay (3)."""
        given = {**measured, "speed_reference": var("speed_reference")}
        demand(set(law["inputs"]) <= set(given), "the law reads a signal that the plant does not give")
        # By number: a state's own name may be that of another one, of the delay say.
        known = [
            *(var(f"law: {i}") for i in range(len(law["states"]))),
            *(given[name] for name in law["inputs"]),
        ]
        values = []

        def row(by_state, by_input, by_curve):
            # Of the curves, a row reads those before it: the others stand there as zeros.
            return combined([*by_state, *by_input, *by_curve[: len(values)]], [*known, *values])

        def curve(argument, points, left, right):
            a, b, sigma = normalised(points, left, right)
            values.append(a * argument + b * self.add_curve(f"curve_{len(values)}", sigma, argument))

        for i, content in enumerate(law["curves"]):
            demand(not any(law["H"][i][i:]), "an algebraic loop in the law")
            points = [(z, w) for z, w in content["points"]]
            argument = row(law["F"][i], law["G"][i], law["H"][i])
            curve(argument, points, content["slope_left"], content["slope_right"])
        torque = row(law["C"][0], law["D"][0], law["J"][0])
        after = [row(*rows) for rows in zip(law["A"], law["B"], law["E"], strict=True)]
        own = own_limit(law)
        self.limit = None if own is None else f"curve_{own}"
        highest = None if own is None else max(abs(w) for _, w in law["curves"][own]["points"])
        if limit is not None and (highest is None or highest > limit):
            demand(limit > 0, "a torque limit that is not positive")
            self.limit = f"curve_{len(values)}"
            curve(torque, [(-limit, -limit), (limit, limit)], NOTHING, NOTHING)
            torque = values[-1]
        line = [f"law: torque_motor_{i + 1}" for i in range(delay)]
        held = [torque, *map(var, line)]
        self.jump["torque_motor"] = held[-1]
        self.jump.update({f"law: {i}": form for i, form in enumerate(after)})
        self.jump.update(zip(line, held))

    def add_memory(self, places):
        """Arguments of curves at the last sample as states more, and the curves' values then as curves (27)."""
        names = list(self.curves)
        for place in places:
            name = names[whole(place, 0)]
            state = f"law: {name} at the last sample"
            demand(state not in self.jump, "two states of one name")
            self.jump[state] = self.arguments[name]
            self.add_curve(f"{name} at the last sample", self.curves[name], var(state))

    def make_continuous(self):
        """A law in continuous time: its rows give rates, and its torque acts at once (23)."""
        by = {"torque_motor": self.jump.pop("torque_motor")}
        self.rates = {name: form.at(by) for name, form in {**self.rates, **self.jump}.items()}
        self.jump, self.plant_curves = {}, list(self.curves)
        reads = {name for form in self.arguments.values() for name in form}
        demand(reads <= set(self.rates), "a curve reads more than states")

    def deviation(self, form):
        """The form without what stands still at an equilibrium."""
        return Form({name: value for name, value in form.items() if name not in self.still})


# --- rests, sectors, copies -------------------------------------------------------------------------------------------


def equilibrium(loop, segments, speed, torque_load):
    """Arguments of all curves, and states, at rest: every curve continued along its segment (4), then checked (5)."""
    lines = {}
    for name, segment in zip(loop.curves, segments, strict=True):
        value, slope = loop.curves[name].line(segment)
        lines[name] = Form({"1": value}) + slope * loop.arguments[name]
    equations = [form.at({"torque_load": Form({"1": torque_load})}) for form in loop.rates.values()]
    equations += [form - var(name) for name, form in (*loop.jump.items(), *lines.items())]
    equations.append(var("speed_load") - Form({"1": speed}))
    found = solve(equations, [*loop.states, *loop.curves, "speed_reference"])
    arguments = {}
    for name, segment in zip(loop.curves, segments, strict=True):
        arguments[name] = sum(value * found[key] for key, value in loop.arguments[name].items())
        demand(loop.curves[name].segment(arguments[name]) == segment, f"{name} rests on another segment")
    return arguments, {name: found[name] for name in loop.states}


def sectors_of(loops, rests):
    """Sector of each curve for all equilibria between those of the loops (6, 7)."""
    found = {}
    for name in loops[0].curves:
        each = [loop.curves[name].sector(at[name]) for loop, own in zip(loops, rests) for at, _ in own]
        found[name] = min(low for low, _ in each), max(high for _, high in each)
    return found


def copies_of(loop, rests):
    """(slope, slack, loss) of all pairs of arguments of one rising curve (8, 9); of a jump slope and slack are 1."""
    found = {}
    for pair in combinations(loop.curves, 2):
        curve = loop.curves[pair[0]]
        if curve.key != loop.curves[pair[1]].key or not curve.rises or curve.steepest == 0:
            continue
        slope, slack, loss = curve.steepest or ONE, NOTHING, NOTHING
        corners = [(arguments[pair[0]], arguments[pair[1]]) for arguments, _ in rests]
        if any(a != b for a, b in corners):
            segments = {curve.segment(z) for corner in corners for z in corner}
            if len(segments) != 1 or curve.slopes[segments.pop()] != 0:
                continue
            ends = [end for end, _ in curve.points]
            apart = max(abs(a - b) / abs(z - end) for a, b in corners for z in (a, b) for end in ends)
            slack = min(Fraction(1, 4), 64 * apart)
            loss = (slope * apart) ** 2 / (4 * slack)
        found[pair] = slope, slack + (curve.steepest is None), loss
    return found


def ends_of(claim, loop):
    """Corners of the ranges of load speed and load torque."""
    speeds, torques = (claim["speed_from"], claim["speed_to"]), claim["torque_load"]
    demand(len(torques) == 2 and torques[0] <= torques[1], "no ranges of load torque in the claim")
    demand(0 < speeds[0] <= speeds[1], "no ranges of speed in the claim")
    alike = all(curve.is_odd for curve in loop.curves.values())
    demand(alike or not claim["both_directions"], "the two directions differ")
    return [(r, m) for r in sorted(set(speeds)) for m in sorted(set(torques))]


def region_of(loop, claim, sectors, rests, ends):
    """Where the limit's sector is [share · slope, slope]: within reach of its argument (16). Changes the sector."""
    step, share = claim["limit"]["step"], claim["limit"]["share"]
    demand(loop.limit is not None, "there is no torque limit")
    demand(loop.limit in loop.moving, "the torque limit reads nothing")
    demand(step > 0 and 0 < share <= 1, "no step or no share in the claim")
    curve, high = loop.curves[loop.limit], sectors[loop.limit][1]
    for arguments, _ in rests:
        for name, other in loop.curves.items():
            slope = other.line(other.segment(arguments[name]))[1]
            if name == loop.limit:
                demand(slope == high, "the limit acts at rest")
            else:  # no other curve changes its value from one rest to the other: every integral is zero there
                demand(slope == 0 or name in loop.still, f"{name} rests on a slope")
    room = min(abs(arguments[loop.limit] - z) for arguments, _ in rests for z, _ in curve.points)
    sectors[loop.limit] = share * high, high
    span = claim["speed_to"] - claim["speed_from"]
    demand(span > 0, "the claim has no room for a step")
    low, high = (rests[ends.index((claim[end], ends[0][1]))][1] for end in ("speed_from", "speed_to"))
    start = {name: (high[name] - low[name]) / span * step for name in low}
    return {"reach": room / share, "start": start}


# --- the proof --------------------------------------------------------------------------------------------------------


class Proof:
    """The inequalities, with P and multipliers taken from the certificate in their order."""

    def __init__(self, loop, sectors, copies, dt, numbers, region):
        self.loop, self.sectors, self.copies, self.region = loop, sectors, copies, region
        if region is not None:  # (17) asks what a limit that does not act would do: that has no copies
            self.copies = {pair: known for pair, known in copies.items() if loop.limit not in pair}
        demand(set(numbers) <= NUMBERS, "the certificate was written by another version: prove it again")
        self.substeps = whole(numbers["substeps"], 1)
        self.step = dt / self.substeps
        self.of_state, self.seen = self.curves_of_the_state(), self.curves_seen()
        self.zeta = [*loop.states, *self.of_state]
        self.p, size = numbers["P"], len(self.zeta)
        demand(len(self.p) == self.substeps + 1, "not as many matrices P as knots")
        for p in self.p:
            demand(len(p) == size and all(len(row) == size for row in p), "a matrix P of another size")
            demand(all(p[i][j] == p[j][i] for i in range(size) for j in range(i)), "P is not symmetric")
        self.multipliers = {name: list(values) for name, values in numbers["multipliers"].items()}
        positive = all(m >= 0 for values in self.multipliers.values() for m in values)
        demand(positive, "a multiplier is negative")
        self.eta, self.theta = self.signed("eta", loop.plant_curves), self.signed("theta", self.of_state)

    def curves_of_the_state(self):
        """Rising law curves without a jump whose argument is the law's state alone: the integrals of V (10)."""
        found, known = [], {s for s in self.loop.states if s.startswith("law: ")}
        for name in self.loop.moving:
            curve, reads = self.loop.curves[name], set(self.loop.deviation(self.loop.arguments[name]))
            is_region = self.region is not None and name == self.loop.limit
            if reads <= {*known, *found} and curve.rises and curve.steepest and not is_region:
                found.append(name)
        return found

    def curves_seen(self):
        """Plant curves that the law reads at a sample, or has copies of."""
        moving = self.loop.moving
        forms = [*self.loop.jump.values(), *(self.loop.arguments[name] for name in moving)]
        read = {name for form in forms for name in form}
        read |= {name for pair in self.copies for name in pair if set(pair) & set(moving)}
        return [name for name in self.loop.plant_curves if name in read]

    def signed(self, name, curves):
        """Weights of the integrals, as (positive part, negative part)."""
        parts = self.multipliers[f"{name}_plus"], self.multipliers[f"{name}_minus"]
        return dict(zip(curves, zip(*parts, strict=True), strict=True))

    def evaluated(self, names, by=None):
        """(name, argument, value) of curves, with states and values replaced."""
        by = by or {}
        return [(n, self.loop.deviation(self.loop.arguments[n]).at(by), by.get(n, var(n))) for n in names]

    def subtract_known(self, total, where, curves):
        """Takes what is known of curves to be ≥ 0 times its multipliers off: sectors (7), then copies (8, 9).

        ``curves``: (curve's name, form of its argument, form of its value).
        """
        factors, pairs = self.multipliers[where], list(self.pairs(curves))
        demand(len(factors) == len(curves) + len(pairs), f"{where}: not as many multipliers as conditions")
        for factor, (name, z, w) in zip(factors, curves):
            low, high = self.sectors[name]
            add(total, -2 * factor, w - low * z, high * z - w)
        for factor, (slope, slack, loss, (_, z1, w1), (_, z2, w2)) in zip(factors[len(curves) :], pairs):
            add(total, -2 * factor, w1 - w2, slope * (z1 - z2) + (slack - 1) * (w1 - w2))
            add(total, -2 * factor * loss, z1, z1)
            add(total, -2 * factor * loss, z2, z2)

    def pairs(self, curves):
        """What is known of two evaluations of one curve, or of a curve and its copy."""
        for a, b in combinations(curves, 2):
            known = self.copies.get((a[0], b[0])) or self.copies.get((b[0], a[0]))
            if a[0] == b[0]:
                known = self.loop.curves[a[0]].steepest, NOTHING, NOTHING
            if known:
                yield (*known, a, b)

    def holds(self):
        """Step 6 and 7; of a law in continuous time P is constant, and nothing happens at samples (23)."""
        sampled = bool(self.loop.jump)
        still = self.substeps == 1 and self.p[0] == self.p[1]
        demand(sampled or still, "P changes although the law acts in continuous time")
        for k in range(self.substeps + 1 if sampled else 1):
            demand(self.is_positive(k), f"V is not positive at knot {k} (12)")
        for k in range(self.substeps):
            for end in (0, 1) if sampled else (0,):
                demand(self.falls(k, end), f"V does not fall in substep {k}, end {end} (13)")
        demand(not sampled or self.does_not_rise(), "V rises at a sample (15)")
        if self.region is not None:
            self.keeps_the_region()

    def least(self, k):
        """V at knot k, with the largest value of each integral that it subtracts (11)."""
        total, here = {}, [var(name) for name in self.zeta]
        add_matrix(total, 1, self.p[k], here, here)
        for name, (_, negative) in (*self.eta.items(), *self.theta.items()):
            z = self.loop.deviation(self.loop.arguments[name])
            add(total, -negative * self.sectors[name][1], z, z)
        return total

    def is_positive(self, k):
        """(12): what V at knot k is at least, is positive."""
        total = self.least(k)
        self.subtract_known(total, f"rest_{k}", self.evaluated(self.of_state))
        return positive_definite(total, self.zeta)

    def falls(self, k, end):
        """(13): −dV/dτ at one end of substep k, times the length of the substep."""
        total, here = {}, [var(name) for name in self.zeta]
        rates = {name: self.step * self.loop.deviation(form) for name, form in self.loop.rates.items()}
        add_matrix(total, -2, self.p[k + end], [rates.get(name, Form()) for name in self.zeta], here)
        add_matrix(total, 1, self.p[k], here, here)
        add_matrix(total, -1, self.p[k + 1], here, here)
        for name, (positive, negative) in self.eta.items():
            add(total, -2 * (positive - negative), var(name), self.loop.arguments[name].at(rates))
        curves = self.evaluated([*self.loop.plant_curves, *self.of_state])
        self.subtract_known(total, f"flow_{k}_{end}", curves)
        return positive_definite(total, [*self.zeta, *self.loop.plant_curves])

    def does_not_rise(self):
        """(15): V before minus V after a sample, with the bounds (14) on what the integrals change."""
        loop, later_names = self.loop, {name: f"{name} after" for name in self.of_state}
        by = {name: loop.deviation(form) for name, form in loop.jump.items()}
        by |= {name: var(later) for name, later in later_names.items()}
        total, before = {}, [var(name) for name in self.zeta]
        after = [by.get(name, var(name)) for name in self.zeta]
        add_matrix(total, 1, self.p[-1], before, before)
        add_matrix(total, -1, self.p[0], after, after)
        now, later = self.evaluated([*self.seen, *loop.moving]), self.evaluated(self.of_state, by)
        for (name, z1, w1), (_, z0, w0) in zip(later, self.evaluated(self.of_state)):
            positive, negative = self.theta[name]
            add(total, -2 * positive, w1, z1 - z0)
            add(total, 2 * negative, w0, z1 - z0)
            add(total, (positive + negative) / loop.curves[name].steepest, w1 - w0, w1 - w0)
        self.subtract_known(total, "jump", now + later)
        return positive_definite(total, [*loop.states, *self.seen, *loop.moving, *later_names.values()])

    def keeps_the_region(self):
        """V before a sample is at least level · (the limit's argument)² (17), and the step starts below (18)."""
        loop, (level,) = self.loop, self.multipliers["level"]
        total, s = self.least(self.substeps), loop.deviation(loop.arguments[loop.limit])
        add(total, -level, s, s)
        self.subtract_known(total, "region", self.evaluated([*self.seen, *loop.moving]))
        held = positive_definite(total, [*loop.states, *self.seen, *loop.moving])
        demand(held, "the level does not keep the torque in its region (17)")
        start = [self.region["start"].get(name, NOTHING) for name in self.zeta]
        v = sum(a * b * value for a, row in zip(start, self.p[-1]) for b, value in zip(start, row))
        demand(v < level * self.region["reach"] ** 2, "the step starts above the level (18)")


# --- curves -----------------------------------------------------------------------------------------------------------


class Curve:
    """w(z) through points, with end slopes; two points with one z are a jump (2)."""

    def __init__(self, points, left=NOTHING, right=NOTHING):
        self.points, self.slopes = points, [left]
        for (z0, w0), (z1, w1) in zip(points, points[1:]):
            demand(z1 > z0 or (z1 == z0 and w1 > w0), "a curve's points are not in order")
            self.slopes.append((w1 - w0) / (z1 - z0) if z1 > z0 else None)
        self.slopes.append(right)
        self.rises = all(slope is None or slope >= 0 for slope in self.slopes)
        self.steepest = None if None in self.slopes else max(self.slopes)
        self.key = tuple(points), left, right
        self.is_odd = self.key == (tuple((-z, -w) for z, w in reversed(points)), right, left)

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
        chords = [slope, self.slopes[0], self.slopes[-1], *((w - here) / (x - z) for x, w in self.points)]
        return min(chords), max(chords)


def normalised(points, left, right):
    """(a, b, σ): the curve is a·z + b·σ(z), σ of height 1 where the end slopes are alike (2)."""
    if left != right:
        return NOTHING, ONE, Curve(points, left, right)
    flat = [(z, w - right * z) for z, w in points]
    height = flat[-1][1] - flat[0][1] or ONE
    return right, height, Curve([(z, w / height) for z, w in flat])


# --- linear forms, quadratics, two algorithms -----------------------------------------------------------------------


class Form(dict):
    """A linear expression in named variables: {name: coefficient}."""

    def __add__(self, other):
        return combined((1, 1), (self, other))

    def __sub__(self, other):
        return combined((1, -1), (self, other))

    def __rmul__(self, factor):
        return combined((factor,), (self,))

    def at(self, by):
        """With variables replaced by forms."""
        return combined(self.values(), [by.get(name, var(name)) for name in self])


def var(name):
    return Form({name: ONE})


def combined(coefficients, forms):
    """Σ coefficient · form."""
    total = {}
    for coefficient, form in zip(coefficients, forms, strict=True):
        if coefficient:
            for name, value in form.items():
                total[name] = total.get(name, 0) + coefficient * value
    return Form({name: value for name, value in total.items() if value})


def add(quadratic, factor, a, b):
    """Adds factor · a · b to a quadratic, {(name, name): coefficient}."""
    if factor:
        for i, x in a.items():
            for j, y in b.items():
                quadratic[i, j] = quadratic.get((i, j), 0) + factor * x * y


def add_matrix(quadratic, factor, p, left, right):
    """Adds factor · leftᵀ P right."""
    for row, form in zip(p, left, strict=True):
        add(quadratic, factor, form, combined(row, right))


def positive_definite(quadratic, names):
    """Whether the quadratic is positive for all values but zero; what it calls so, is.

    Variables are scaled by powers of two until the diagonal lies in 1/4 ... 4, the entries rounded to ``BITS`` bits,
    and the most that rounding can have added, less than 1 unit for each entry of a row, is taken off the diagonal. The
    rest are whole numbers: elimination (Bareiss 1968), whose pivots are the leading minors (Sylvester).
    """
    size, place = len(names), {name: i for i, name in enumerate(names)}
    matrix = [[NOTHING] * size for _ in names]
    for (a, b), value in quadratic.items():
        matrix[place[a]][place[b]] += value * HALF
        matrix[place[b]][place[a]] += value * HALF
    diagonal = [matrix[i][i] for i in range(size)]
    if any(d <= 0 for d in diagonal):
        return False
    scale = [Fraction(2) ** ((d.denominator.bit_length() - d.numerator.bit_length()) // 2) for d in diagonal]
    rows = [[round(value * a * b * 2**BITS) for value, b in zip(row, scale)] for row, a in zip(matrix, scale)]
    for i, row in enumerate(rows):
        row[i] -= size
    last = 1
    for i in range(size):
        pivot = rows[i][i]
        if pivot <= 0:
            return False
        for j in range(i + 1, size):
            for k in range(j, size):
                rows[j][k] = (rows[j][k] * pivot - rows[i][j] * rows[i][k]) // last
        last = pivot
    return True


def solve(equations, unknowns):
    """Values of the unknowns for which every form is zero."""
    rows = [[form.get(name, NOTHING) for name in (*unknowns, "1")] for form in equations]
    demand(len(rows) == len(unknowns), "the equilibrium has not as many equations as unknowns")
    for i in range(len(rows)):
        pivot = next((j for j in range(i, len(rows)) if rows[j][i]), None)
        demand(pivot is not None, "the loop has no single equilibrium")
        rows[i], rows[pivot] = rows[pivot], rows[i]
        rows[i] = [value / rows[i][i] for value in rows[i]]
        for j, row in enumerate(rows):
            if j != i and row[i]:
                rows[j] = [a - row[i] * b for a, b in zip(row, rows[i])]
    return {name: -row[-1] for name, row in zip(unknowns, rows)}


# --- the command ------------------------------------------------------------------------------------------------------


def read(path):
    with open(path, encoding="utf-8") as file:  # noqa: PTH123 (a script without further imports)
        return parsed(file.read())


def parsed(text):
    """JSON in exact fractions: the number that each decimal means as a float."""
    return json.loads(text, parse_float=exact, parse_int=Fraction, parse_constant=no_number)


def exact(digits):
    return Fraction(float(digits))


def no_number(word):
    raise NotProved(f"{word} is no number")


def said(claim):
    """The claim in words."""
    low, high, *torques = map(float, (claim["speed_from"], claim["speed_to"], *claim["torque_load"]))
    boxes = ["For {} times {!r} to {!r},".format(n, *map(float, e)) for n, e in claim.get("box", {}).items()]
    torque = f"load torque {torques[0]!r} to {torques[1]!r} Nm"
    start = "from every state"
    if claim["limit"] is not None:
        start = f"after steps of the load speed between them by up to {float(claim['limit']['step'])!r} rad/s"
    directions = "both directions" if claim["both_directions"] else "the positive direction"
    proved = f"PROVED: asymptotically stable at every load speed from {low!r} to {high!r} rad/s,"
    return "\n".join([*boxes, proved, f"        in {directions}, {torque},", f"        {start}"])


def main(paths):
    if len(paths) not in (1, 2):
        print(__doc__)
        return 2
    try:
        claim = verify(*map(read, paths))
    except NotProved as reason:
        print(f"NOT PROVED: {reason}")
    except (OSError, *NO_CERTIFICATE) as error:
        print(f"NOT PROVED: the file is no certificate ({type(error).__name__}: {error})")
    else:
        print(said(claim))
        return 0
    return 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
