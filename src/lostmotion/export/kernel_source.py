"""C functions from compiled Python kernels: the same operations in the same order, so the same bits.

It knows the part of Python in which an exportable step is written: numbers, arrays and their slices, ``for`` over a
range, ``while``, ``if``, and calls of other such kernels. All else is refused, above all what C would do in another
way: whole numbers divided, an index from the end, a variable that is first whole and then real.
"""

from __future__ import annotations

import ast
import inspect
import math
import textwrap
from typing import Any

#: Types of a value: real number, whole number or truth, array.
REAL, WHOLE, ARRAY = "real", "whole", "array"
_OPERATORS = {
    ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=",
    ast.Eq: "==", ast.NotEq: "!=", ast.And: "&&", ast.Or: "||", ast.USub: "-", ast.Not: "!",
}  # fmt: skip
_CASTS = {"int": WHOLE, "float": REAL}


def c_functions(kernel: Any, real: str) -> list[str]:
    """A kernel and all that it calls as C functions, each after those that it calls; ``real`` is the number type.

    Raises
    ------
    TypeError
        If a kernel uses what has no counterpart here.
    """
    written: dict[str, _Function] = {}
    _read(kernel, real, written)
    return [function.text() for function in written.values()]


def _read(kernel: Any, real: str, written: dict[str, _Function]) -> None:
    function = _Function(kernel, real)
    for called in function.calls:
        name = called.py_func.__name__
        if name not in written:
            _read(called, real, written)
        elif written[name].kernel is not called:
            raise TypeError(f"{function.name}: there are two kernels {name}, C has one name for each")
    function.find_changed(written)
    written[function.name] = function


class _Function:
    """One kernel: its types, then its text."""

    def __init__(self, kernel: Any, real: str) -> None:
        (tree,) = ast.parse(textwrap.dedent(inspect.getsource(kernel.py_func))).body
        assert isinstance(tree, ast.FunctionDef)
        self.kernel, self.tree, self.name, self.real = kernel, tree, tree.name, real
        if len(kernel.nopython_signatures) != 1:
            raise TypeError(
                f"{self.name}: compiled for {len(kernel.nopython_signatures)} signatures, not one"
            )
        (signature,) = kernel.nopython_signatures
        self.scope: dict[str, Any] = kernel.py_func.__globals__
        self.arguments = dict(
            zip((a.arg for a in tree.args.args), map(_type_of, signature.args), strict=True)
        )
        self.returns = _type_of(signature.return_type)
        self.changed: set[str] = set()
        self.types = dict(self.arguments)
        for node in ast.walk(tree):
            if isinstance(node, ast.For) and isinstance(node.target, ast.Name):
                self.types[node.target.id] = WHOLE
        # In the order of the lines: a variable has the type of its first value.
        for node in sorted((n for n in ast.walk(tree) if isinstance(n, ast.Assign)), key=lambda n: n.lineno):
            for target, value in _pairs(node):
                if isinstance(target, ast.Name):
                    self.types.setdefault(target.id, self.type_of(value))
                    self.check_stays(target.id, value)
        for node in ast.walk(tree):
            if isinstance(node, ast.AugAssign) and isinstance(node.target, ast.Name):
                self.check_stays(node.target.id, ast.BinOp(node.target, node.op, node.value))

    def check_stays(self, name: str, value: ast.expr) -> None:
        """A whole number that becomes a real one is real from the start in Python's compiler, and cut off in C."""
        if self.types[name] == WHOLE and self.type_of(value) == REAL:
            raise TypeError(f"{self.name}: {name} is a whole number first and a real one later")

    def find_changed(self, written: dict[str, _Function]) -> None:
        """Names of the arrays that the function writes into, itself or by a function it calls; the others are const."""
        for node in ast.walk(self.tree):
            if isinstance(node, ast.Subscript) and isinstance(node.ctx, ast.Store):
                self.changed |= _names(node.value)
            elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in written:
                called = written[node.func.id]
                for name, value in zip(called.arguments, node.args, strict=True):
                    if name in called.changed:
                        self.changed |= _names(value.value if isinstance(value, ast.Subscript) else value)

    @property
    def calls(self) -> list[Any]:
        names = [
            n.func.id for n in ast.walk(self.tree) if isinstance(n, ast.Call) and isinstance(n.func, ast.Name)
        ]
        return [self.scope[name] for name in dict.fromkeys(names) if hasattr(self.scope.get(name), "py_func")]

    def text(self) -> str:
        arguments = ", ".join(self.declared(name, kind) for name, kind in self.arguments.items())
        local = [
            f"    {self.declared(n, kind)};" for n, kind in self.types.items() if n not in self.arguments
        ]
        body = [line for statement in self.tree.body for line in self.lines(statement, 1)]
        head = f"static {self.declared(self.name, self.returns)}({arguments})"
        return "\n".join([head, "{", *local, *body, "}"])

    def declared(self, name: str, kind: str) -> str:
        const = "" if name in self.changed else "const "
        return {REAL: f"{self.real} {name}", WHOLE: f"long {name}", ARRAY: f"{const}{self.real} *{name}"}[
            kind
        ]

    def lines(self, node: ast.stmt, depth: int) -> list[str]:
        pad = "    " * depth
        if isinstance(node, ast.Expr):
            is_text = isinstance(node.value, ast.Constant)
            return [] if is_text else [f"{pad}{self.of(node.value)};"]
        if isinstance(node, ast.Assign):
            return [f"{pad}{self.of(target)} = {self.of(value)};" for target, value in _pairs(node)]
        if isinstance(node, ast.AugAssign):
            # As Python does it: the right side first, as a whole.
            return [f"{pad}{self.of(node.target)} = {self.operation(node.target, node.op, node.value)};"]
        if isinstance(node, ast.Return) and node.value is not None:
            return [f"{pad}return {self.of(node.value)};"]
        if isinstance(node, ast.If | ast.While | ast.For):
            return self.block(node, pad, depth)
        raise TypeError(f"{self.name}: {type(node).__name__} has no C counterpart here")

    def block(self, node: ast.If | ast.While | ast.For, pad: str, depth: int) -> list[str]:
        body = [line for statement in node.body for line in self.lines(statement, depth + 1)]
        if node.orelse and not isinstance(node, ast.If):
            raise TypeError(f"{self.name}: the else of a loop has no C counterpart here")
        if isinstance(node, ast.For):
            return [*self.counting(node, pad), *body, f"{pad}}}"]
        word = "if" if isinstance(node, ast.If) else "while"
        other = [line for statement in node.orelse for line in self.lines(statement, depth + 1)]
        tail = [f"{pad}}} else {{", *other, f"{pad}}}"] if other else [f"{pad}}}"]
        return [f"{pad}{word} ({self.of(node.test)}) {{", *body, *tail]

    def counting(self, node: ast.For, pad: str) -> list[str]:
        """The head of a loop over a range.

        Python counts apart from the counter and looks once at the end: so does C where the body changes one of them or
        the counter is also read elsewhere.
        """
        called, counter = node.iter, node.target
        if not (
            isinstance(called, ast.Call)
            and isinstance(called.func, ast.Name)
            and called.func.id == "range"
            and len(called.args) in (1, 2)
            and isinstance(counter, ast.Name)
        ):
            raise TypeError(f"{self.name}: a loop over {ast.unparse(called)} has no C counterpart here")
        name, (first, stop) = counter.id, ("0", *map(self.of, called.args))[-2:]
        loops = [n for n in ast.walk(self.tree) if isinstance(n, ast.For) and _names(n.target) == {name}]
        inside = {id(n) for loop in loops for n in ast.walk(loop)}
        named = [n for n in ast.walk(self.tree) if isinstance(n, ast.Name) and n.id == name]
        changed = {stored for part in node.body for stored in _stored(part)} | self.changed
        if all(id(n) in inside for n in named) and not changed & {name, *_names(called)}:
            return [f"{pad}for ({name} = {first}; {name} < {stop}; {name}++) {{"]
        turn, end = f"turn_of_{name}", f"end_of_{name}"
        head = f"{pad}for (long {turn} = {first}, {end} = {stop}; {turn} < {end}; {turn}++) {{"
        return [head, f"{pad}    {name} = {turn};"]

    def operation(self, left: ast.expr, operator: ast.operator, right: ast.expr) -> str:
        """Two values and the operator between them, the right one as a whole."""
        if isinstance(operator, ast.Div) and REAL not in (self.type_of(left), self.type_of(right)):
            raise TypeError(f"{self.name}: {ast.unparse(left)} / {ast.unparse(right)} is cut off in C")
        return f"{self.of(left)} {_sign(operator)} {self.of(right)}"

    def of(self, node: ast.expr) -> str:
        """An expression; every operation in its brackets, so that none is taken in another order."""
        if isinstance(node, ast.Constant):
            return _number(node.value)
        if isinstance(node, ast.Name):
            return node.id if node.id in self.types else _number(self.scope[node.id])
        if isinstance(node, ast.UnaryOp):
            return f"({_sign(node.op)}{self.of(node.operand)})"
        if isinstance(node, ast.BinOp):
            return f"({self.operation(node.left, node.op, node.right)})"
        if isinstance(node, ast.BoolOp) and all(map(_is_truth, node.values)):
            return "(" + f" {_sign(node.op)} ".join(map(self.of, node.values)) + ")"
        if isinstance(node, ast.Compare):
            sides = [node.left, *node.comparators]
            pairs = zip(sides, node.ops, sides[1:], strict=False)
            return "(" + " && ".join(f"{self.of(a)} {_sign(op)} {self.of(b)}" for a, op, b in pairs) + ")"
        if isinstance(node, ast.IfExp):
            return f"({self.of(node.test)} ? {self.of(node.body)} : {self.of(node.orelse)})"
        if isinstance(node, ast.Subscript):
            return self.element(node)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and not node.keywords:
            values = ", ".join(map(self.of, node.args))
            if node.func.id in _CASTS:
                return f"(({self.real if _CASTS[node.func.id] == REAL else 'long'}){values})"
            if hasattr(self.scope.get(node.func.id), "py_func"):
                return f"{node.func.id}({values})"
        raise TypeError(f"{self.name}: {ast.unparse(node)} has no C counterpart here")

    def element(self, node: ast.Subscript) -> str:
        part = node.slice
        first = (part.lower or ast.Constant(0)) if isinstance(part, ast.Slice) else part
        if isinstance(first, ast.UnaryOp) or (isinstance(part, ast.Slice) and part.step is not None):
            raise TypeError(f"{self.name}: {ast.unparse(node)} has no C counterpart here")
        if isinstance(part, ast.Slice):
            return f"({self.of(node.value)} + {self.of(first)})"
        return f"{self.of(node.value)}[{self.of(first)}]"

    def type_of(self, node: ast.expr) -> str:
        if isinstance(node, ast.Subscript):
            return ARRAY if isinstance(node.slice, ast.Slice) else REAL
        if isinstance(node, ast.Name) and node.id in self.types:
            return self.types[node.id]
        if isinstance(node, ast.Name | ast.Constant):
            value = self.scope[node.id] if isinstance(node, ast.Name) else node.value
            return REAL if isinstance(value, float) else WHOLE
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            if node.func.id in _CASTS:
                return _CASTS[node.func.id]
            return _type_of(self.scope[node.func.id].nopython_signatures[0].return_type)
        if isinstance(node, ast.BinOp):
            either = (self.type_of(node.left), self.type_of(node.right))
            return REAL if REAL in either or isinstance(node.op, ast.Div) else WHOLE
        if isinstance(node, ast.UnaryOp):
            return self.type_of(node.operand)
        if isinstance(node, ast.IfExp):
            return REAL if REAL in (self.type_of(node.body), self.type_of(node.orelse)) else WHOLE
        return WHOLE


def _pairs(node: ast.Assign) -> list[tuple[ast.expr, ast.expr]]:
    """Targets and values; of a tuple one after the other, which is the same while no value uses an earlier target."""
    target = node.targets[0]
    if len(node.targets) == 1 and not isinstance(target, ast.Tuple):
        return [(target, node.value)]
    if len(node.targets) > 1 or not isinstance(target, ast.Tuple) or not isinstance(node.value, ast.Tuple):
        raise TypeError(f"{ast.unparse(node)} has no C counterpart here")
    names = {n.id for n in target.elts if isinstance(n, ast.Name)}
    used = set().union(*map(_names, node.value.elts[1:]))
    if names & used or len(names) < len(target.elts):
        raise TypeError(f"{ast.unparse(node)}: a value uses what is assigned beside it")
    return list(zip(target.elts, node.value.elts, strict=True))


def _names(node: ast.AST) -> set[str]:
    return {n.id for n in ast.walk(node) if isinstance(n, ast.Name)}


def _stored(node: ast.AST) -> set[str]:
    return {n.id for n in ast.walk(node) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}


def _is_truth(node: ast.expr) -> bool:
    """Whether the value is true or false, of which Python and C make the same with ``and`` and ``or``."""
    return isinstance(node, ast.Compare | ast.BoolOp) or (
        isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not)
    )


def _sign(operator: ast.AST) -> str:
    if type(operator) not in _OPERATORS:
        raise TypeError(f"{type(operator).__name__} has no C counterpart here")
    return _OPERATORS[type(operator)]


def _number(value: Any) -> str:
    if isinstance(value, float) and math.isfinite(value):
        return f"R({value!r})"
    if isinstance(value, int):
        return f"{int(value)}"
    raise TypeError(f"{value!r} has no C counterpart here")


def _type_of(numba_type: Any) -> str:
    name = str(numba_type).lower()
    if name.startswith(("array(float64, 1d, c", "float64", "int64", "bool", "none")):
        return ARRAY if name.startswith("array") else REAL if name.startswith("float") else WHOLE
    raise TypeError(f"{numba_type} has no C counterpart here")
