"""For which parameters is there a blend at all?  Conditions of existence, case by case.

With symbols in the data (radii, distances) the conditions of contact are a linear system in the
coefficients of one polynomial whose entries are polynomials in the parameters.  Elimination splits
the parameters into cases; each comes with the dimension and with all solutions in closed form.
For two perpendicular cylinders of radii r_i at distances d_i a cubic exists iff
r1^2 + d1^2 = r2^2 + d2^2; as a condition for blends of any degree, which it was published as (Yu, Sun and Ma 2006), it
is wrong.

Guaranteed: the cases do not overlap and together are all real parameters that the assumptions
allow; in each the solutions satisfy every contact identically (each is multiplied out again) and
are linearly independent.  Not guaranteed: that a case has a real point; what the signs of the
parameters or an ideal that is the whole ring show to be empty is dropped.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias, Unpack

from flint import Ordering, fmpq_mpoly, fmpq_mpoly_ctx

from pas.algebra.brief import brief
from pas.algebra.expressions import read_polynomial
from pas.algebra.ideal import divided
from pas.algebra.inputs import check_degree, check_order
from pas.algebra.locus import ANY, Locus, Parameters, Sign
from pas.algebra.monomials import exponents
from pas.algebra.parametric import (
    ParametricNullspace,
    Terms,
    independent,
    membership_rows,
    merged,
    parametric_nullspaces,
    remainders_modulo,
)
from pas.algebra.polynomial import VARIABLES, as_sympy, primitive
from pas.algebra.rational import Exact, Symbolic, rational
from pas.errors import GeometryError
from pas.limits import WorkLimits, limited

if TYPE_CHECKING:
    import sympy

SymbolLike: TypeAlias = "str | sympy.Symbol"
"""What is taken for a parameter: a name or a symbol."""


@dataclass(frozen=True, eq=False)
class ExistenceCase:
    """One case: where all `conditions` are zero and no inequation is (sympy polynomials).

    `basis` holds `dimension` independent solutions there, sympy expressions in x, y, z and the parameters.
    """

    conditions: tuple[sympy.Expr, ...]
    inequations: tuple[sympy.Expr, ...]
    dimension: int
    basis: tuple[sympy.Expr, ...]
    __repr__ = brief

    def __str__(self) -> str:
        where = [f"{c} = 0" for c in self.conditions] + [f"{c} != 0" for c in self.inequations]
        return "\n".join(
            [f"{', '.join(where) or 'always'}: dimension {self.dimension}", *(f"    {g}" for g in self.basis)]
        )

    def _repr_latex_(self) -> str:
        import sympy

        where = [f"{sympy.latex(c)} = 0" for c in self.conditions]
        where += [f"{sympy.latex(c)} \\ne 0" for c in self.inequations]
        solutions = ", ".join(sympy.latex(g) for g in self.basis)
        return f"${', '.join(where) or chr(92) + 'text{always}'}: \\dim = {self.dimension} \\quad {solutions}$"


@dataclass(frozen=True, eq=False)
class Existence:
    """All cases of one question: polynomials of degree <= `degree` with GC^`order` at each contact."""

    order: int
    degree: int
    parameters: tuple[sympy.Symbol, ...]
    cases: tuple[ExistenceCase, ...]
    __repr__ = brief

    @property
    def exists(self) -> tuple[ExistenceCase, ...]:
        """The cases in which there is a solution."""
        return tuple(case for case in self.cases if case.dimension)

    def at(self, values: Mapping[str | sympy.Symbol, Exact]) -> ExistenceCase:
        """The case that holds for given exact values of all parameters (by symbol or name).

        Raises `ValueError` for missing parameters or values that the assumptions exclude.
        """
        import sympy

        named = {str(key): value for key, value in values.items()}
        missing = [str(p) for p in self.parameters if str(p) not in named]
        if missing:
            raise ValueError(f"values must have a number for each parameter; {', '.join(missing)} is missing")
        numbers = {}
        for p in self.parameters:
            exact = rational(named[str(p)], f"the value of {p}")
            number = sympy.Rational(int(exact.p), int(exact.q))
            if int(sympy.sign(number)) not in _allowed(p):
                raise ValueError(f"the value {number} of {p} contradicts what is assumed of it")
            numbers[p] = number
        for case in self.cases:
            if all(c.subs(numbers) == 0 for c in case.conditions) and all(
                c.subs(numbers) != 0 for c in case.inequations
            ):
                return case
        raise ValueError("the values belong to no case, though the cases are complete: please report this")

    def __str__(self) -> str:
        head = f"GC^{self.order}, degree <= {self.degree}: "
        if not self.exists:
            return f"{head}never a solution"
        return head + "\n" + "\n".join(f"  {line}" for case in self.cases for line in str(case).splitlines())

    def _repr_latex_(self) -> str:
        return "\n\n".join(case._repr_latex_() for case in self.cases)


@limited("solving with parameters", "a lower degree")
def existence(
    contacts: Sequence[tuple[str | Symbolic, str | Symbolic]],
    order: int,
    degree: int,
    parameters: SymbolLike | Sequence[SymbolLike],
    **limits: Unpack[WorkLimits],
) -> Existence:
    """The conditions under which a polynomial of degree <= `degree` meets all contacts with GC^`order`.

    Elimination splits the parameters into cases (Sit 1992).

    `contacts` are pairs (surface, clip): strings or sympy expressions in x, y, z and the `parameters`, which are sympy
    symbols (positive, negative, nonnegative, nonzero or real) or names (real).

    Raises `ValueError` for other symbols, expressions that are not polynomial or no parameters,
    `GeometryError` where leading terms depend on the parameters, `LimitError` past a deadline.
    """
    check_order(order)
    check_degree(degree)
    symbols = _symbols(parameters)
    ring = Parameters({str(p): _allowed(p) for p in symbols})
    pairs = [_pair(contact, i, symbols) for i, contact in enumerate(contacts)]
    if not pairs:
        raise ValueError("contacts must hold at least one pair (surface, clip)")
    rows = []
    for number, (surface, clip) in enumerate(pairs, start=1):
        try:
            remainders = remainders_modulo([_terms(surface, ring), _terms(clip ** (order + 1), ring)])
        except ValueError as error:
            raise GeometryError(
                f"contact {number}: {error}; write the surface and the clip so that the terms of highest degree "
                "are free of parameters and have no common variable, as in y^2 + z^2 - r^2 and x - d"
            ) from None
        rows += membership_rows(remainders, degree)
    unknowns = len(exponents(degree))
    found = list(parametric_nullspaces(rows, unknowns, Locus(ring)))
    for solution in found:
        _check(solution, rows)
    ideals = [(f, h ** (order + 1)) for f, h in pairs]
    return Existence(order, degree, symbols, tuple(_case(s, degree, symbols, ideals) for s in merged(found)))


def _symbols(parameters: SymbolLike | Sequence[SymbolLike]) -> tuple[sympy.Symbol, ...]:
    import sympy

    given = (parameters,) if isinstance(parameters, str | sympy.Symbol) else parameters
    symbols = tuple(sympy.Symbol(p, real=True) if isinstance(p, str) else p for p in given)
    if not symbols:
        raise ValueError("parameters must hold at least one symbol; without any, ask pas.solutions")
    for p in symbols:
        if not isinstance(p, sympy.Symbol):
            raise TypeError(f"parameters must be sympy symbols or names, not {p!r}")
        if str(p) in VARIABLES:
            raise ValueError(f"a parameter must not be called {p}: x, y, z are the variables")
    if len({str(p) for p in symbols}) < len(symbols):
        raise ValueError("parameters must have different names")
    return symbols


def _allowed(symbol: Any) -> Sign:
    """The signs that a symbol's assumptions leave."""
    known = {1: symbol.is_positive, -1: symbol.is_negative, 0: symbol.is_zero}
    return frozenset(sign for sign, holds in known.items() if holds is not False) or ANY


def _pair(contact: Any, number: int, symbols: Sequence[Any]) -> tuple[fmpq_mpoly, fmpq_mpoly]:
    if not isinstance(contact, tuple | list) or len(contact) != 2:
        raise TypeError(f"contacts[{number}] must be a pair (surface, clip), not {contact!r}")
    surface, clip = (
        _read(expression, f"the {name} of contact {number + 1}", symbols)
        for expression, name in zip(contact, ("surface", "clip"), strict=True)
    )
    return surface, clip


def _read(expression: Any, name: str, symbols: Sequence[Any]) -> fmpq_mpoly:
    """An expression as a polynomial in x, y, z and the parameters."""
    context = _ring(symbols)
    names = (*VARIABLES, *(str(p) for p in symbols))
    if not isinstance(expression, str):
        strange = sorted(str(s) for s in getattr(expression, "free_symbols", ()) if str(s) not in names)
        if strange:
            raise ValueError(f"{name}: {', '.join(strange)} is neither x, y, z nor a parameter")
    try:
        whole = read_polynomial(str(expression), dict(zip(names, context.gens(), strict=True)))
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from None
    if max(whole.degrees()[:3]) < 1:
        raise ValueError(f"{name} must be a polynomial in x, y, z that is not constant, not {expression}")
    return whole


def _terms(whole: fmpq_mpoly, ring: Parameters) -> Terms:
    """A polynomial in x, y, z and the parameters as one in x, y, z over these."""
    collected: dict[tuple[int, ...], dict[tuple[int, ...], Any]] = {}
    for e, c in whole.to_dict().items():
        powers = tuple(map(int, e))
        collected.setdefault(powers[:3], {})[powers[3:]] = c
    return {e: ring.ring.from_dict(terms) for e, terms in collected.items()}


def _check(solution: ParametricNullspace, rows: Sequence[Mapping[int, fmpq_mpoly]]) -> None:
    """Check that each basis member satisfies every equation on its locus, exactly, and that they are independent."""
    for vector in solution.basis:
        for row in rows:
            shared = row.keys() & vector.keys()
            total = sum((row[u] * vector[u] for u in shared), solution.locus.parameters.one * 0)
            if not solution.locus.reduce(total).is_zero():
                raise ArithmeticError("a solution with parameters fails its own conditions")
    if len(independent(solution.basis, solution.locus)) < len(solution.basis):
        raise ArithmeticError("solutions with parameters are not shown to be independent")


def _case(
    solution: ParametricNullspace, degree: int, symbols: Sequence[Any], ideals: Sequence[tuple[fmpq_mpoly, fmpq_mpoly]]
) -> ExistenceCase:
    locus = solution.locus.tidied()
    monomials = exponents(degree)
    members = [_whole({monomials[u]: c for u, c in vector.items()}, symbols) for vector in solution.basis]
    return ExistenceCase(
        tuple(as_sympy(q, symbols) for q in locus.equations),
        tuple(as_sympy(q, symbols) for q in locus.inequations),
        len(members),
        tuple(_readable(g, ideals, (*VARIABLES, *symbols)) for g in members),
    )


def _ring(symbols: Sequence[Any]) -> fmpq_mpoly_ctx:
    """The ring in x, y, z and the parameters."""
    return fmpq_mpoly_ctx.get((*VARIABLES, *(str(p) for p in symbols)), Ordering.degrevlex)


def _whole(terms: Mapping[tuple[int, ...], fmpq_mpoly], symbols: Sequence[Any]) -> fmpq_mpoly:
    """A polynomial over the parameters as one in x, y, z and the parameters."""
    pairs = ((e, c.to_dict().items()) for e, c in terms.items())
    return _ring(symbols).from_dict({(*e, *map(int, f)): v for e, items in pairs for f, v in items})


def _readable(polynomial: fmpq_mpoly, ideals: Sequence[tuple[fmpq_mpoly, fmpq_mpoly]], symbols: Sequence[Any]) -> Any:
    """Factored where that is possible, else as gamma f + beta h^(k+1) for some contact."""
    whole = primitive(polynomial)
    if sum(int(times) for _, times in whole.factor()[1]) == 1:
        for surface, clip in ideals:
            gamma, beta, rest = divided(whole, (surface, clip))
            if rest.is_zero():
                return sum(_factored(a, symbols) * _factored(b, symbols) for a, b in ((gamma, surface), (beta, clip)))
    return _factored(whole, symbols)


def _factored(polynomial: fmpq_mpoly, symbols: Sequence[Any]) -> Any:
    """The product of the irreducible factors as a sympy expression.

    By flint: sympy's own factorisation of these takes minutes now and then.
    """
    import sympy

    content, factors = polynomial.factor()
    powers = (as_sympy(p, symbols) ** int(times) for p, times in factors)
    return sympy.prod(powers, start=sympy.Rational(int(content.p), int(content.q)))
