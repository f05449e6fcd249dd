"""
Print the coefficients of Radau IIA with 3, 5 and 7 stages as C: python scripts/checks/radau_tables.py > src/runtime/methods/radau_tables.h

The nodes c are the zeros of d^(s-1)/dx^(s-1) of x^(s-1) (x - 1)^s. The matrix A integrates the Lagrange polynomials of the nodes from 0 to c_i.
The eigenvalues and eigenvectors of A^-1 decouple the linear systems of Newton's method. The embedded formula gives the error estimate.
All numbers are computed with 60 digits (E. Hairer, G. Wanner: Solving Ordinary Differential Equations II, sections IV.5 and IV.8).
"""

import mpmath as mp

mp.mp.dps = 60
STAGES = (3, 5, 7)


def nodes(s):
    """Return the nodes of the method with s stages, ascending."""
    polynomial = [mp.mpf(0)] * (2 * s)  # coefficients in ascending order
    for k in range(s + 1):
        polynomial[s - 1 + k] = mp.binomial(s, k) * mp.mpf(-1) ** (s - k)
    for _ in range(s - 1):
        polynomial = [j * c for j, c in enumerate(polynomial)][1:]
    roots = mp.polyroots(polynomial[::-1][: s + 1], maxsteps=500, extraprec=400)
    return sorted(mp.re(root) for root in roots)


def lagrange_integrals(points, end):
    """Return the integrals from 0 to `end` of the Lagrange polynomials of the points."""
    size = len(points)
    vandermonde = mp.matrix(size, size)
    for i in range(size):
        for j in range(size):
            vandermonde[i, j] = points[j] ** i
    moments = mp.matrix([end ** (i + 1) / (i + 1) for i in range(size)])
    return list(mp.lu_solve(vandermonde, moments))


def method(s):
    """Return nodes, eigenvalues and eigenvectors of A^-1 (one of each conjugate pair), the inverse of all eigenvectors, and error weights."""
    c = nodes(s)
    a = mp.matrix([lagrange_integrals(c, end) for end in c])
    inverse = a**-1
    values, vectors = mp.eig(inverse)
    order = sorted(range(s), key=lambda j: (abs(mp.im(values[j])), -mp.im(values[j])))
    order = [j for j in order if mp.im(values[j]) > -mp.mpf(10) ** -30]
    full = mp.matrix(s, s)  # columns: the eigenvectors, followed by the conjugates
    columns = [vectors[:, j] / vectors[s - 1, j] for j in order]
    everything = columns + [column.apply(mp.conj) for column in columns[1:]]
    for j, column in enumerate(everything):
        for i in range(s):
            full[i, j] = column[i]
    back = full**-1
    real = mp.re(values[order[0]])
    # The embedded formula has the additional node 0 with the weight 1 / real; its difference from the method, in terms of the stages.
    weight = 1 / real
    moments = mp.matrix([(mp.mpf(1) / (i + 1)) - (weight if i == 0 else 0) for i in range(s)])
    vandermonde = mp.matrix(s, s)
    for i in range(s):
        for j in range(s):
            vandermonde[i, j] = c[j] ** i
    embedded = mp.lu_solve(vandermonde, moments)
    difference = [(embedded[j] - a[s - 1, j]) for j in range(s)]
    errors = [mp.fsum(difference[i] * inverse[i, j] for i in range(s)) * real for j in range(s)]
    return c, [values[j] for j in order], columns, back, errors


def number(value):
    return "0.0" if abs(value) < mp.mpf(10) ** -40 else mp.nstr(value, 18, min_fixed=-2, max_fixed=2)


def rows(matrix):
    return ",\n     ".join("{" + ", ".join(number(x) for x in row) + "}" for row in matrix)


def write(s):
    c, values, columns, back, errors = method(s)
    count = len(values)
    print("    {" + f".stages = {s},")
    print("     .node = {" + ", ".join(map(number, c)) + "},")
    weights = [1 / (c[i] * mp.fprod(c[i] - c[j] for j in range(s) if j != i)) for i in range(s)]
    print("     .weight = {" + ", ".join(map(number, weights)) + "},")
    print("     .value_real = {" + ", ".join(number(mp.re(v)) for v in values) + "},")
    print("     .value_imaginary = {" + ", ".join(number(mp.im(v)) for v in values) + "},")
    print("     .vector_real = {" + rows([[mp.re(columns[j][i]) for j in range(count)] for i in range(s)]) + "},")
    print("     .vector_imaginary = {" + rows([[mp.im(columns[j][i]) for j in range(count)] for i in range(s)]) + "},")
    print("     .back_real = {" + rows([[mp.re(back[j, i]) for i in range(s)] for j in range(count)]) + "},")
    print("     .back_imaginary = {" + rows([[mp.im(back[j, i]) for i in range(s)] for j in range(count)]) + "},")
    print("     .error = {" + ", ".join(map(number, errors)) + "}},")


if __name__ == "__main__":
    print("/* Coefficients of Radau IIA, written by scripts/checks/radau_tables.py; radau.h explains them. */")
    print("static const struct RadauMethod methods[] = {")
    for stages in STAGES:
        write(stages)
    print("};")
