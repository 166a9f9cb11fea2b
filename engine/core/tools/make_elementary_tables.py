#!/usr/bin/env python3
"""Makes engine/core/elementary_tables.hpp: split constants, tables and polynomials of the elementary functions.

Every number comes from mpmath at 450 digits. A polynomial is the minimax fit of Remez' exchange on its interval; its
coefficients are rounded one after the other, lowest first, and the rest is fitted again to what is left, so that the
rounding of a coefficient is made up for by the next ones. Usage: make_elementary_tables.py > elementary_tables.hpp
"""
import struct
import sys

import mpmath as mp

mp.mp.dps = 450


def to_double(value):
    return mp.mpf(float(mp.nstr(value, 60)))


def to_float(value):
    return mp.mpf(struct.unpack("f", struct.pack("f", float(mp.nstr(value, 60))))[0])


def to_bits(value, bits):
    """value with its leading `bits` bits, the rest cut off."""
    exponent = int(mp.floor(mp.log(abs(value), 2))) + 1
    scale = mp.mpf(2) ** (bits - exponent)
    return mp.floor(value * scale) / scale


def solve_remez(function, weight, points, degree):
    """Coefficients and level of the fit whose weighted error alternates on the points."""
    rows = degree + 2
    matrix, right = mp.matrix(rows, rows), mp.matrix(rows, 1)
    for i, x in enumerate(points):
        for j in range(degree + 1):
            matrix[i, j] = weight(x) * x**j
        matrix[i, degree + 1] = (-1) ** i
        right[i] = weight(x) * function(x)
    solution = mp.lu_solve(matrix, right)
    return [solution[j] for j in range(degree + 1)], abs(solution[degree + 1])


def remez(function, weight, low, high, degree, rounds=12, grid=60):
    """Minimax polynomial of weight * (function - p) on [low, high], and its largest weighted error."""
    old_dps, mp.mp.dps = mp.mp.dps, 50
    low, high = mp.mpf(low), mp.mpf(high)
    count = degree + 2
    points = [(low + high) / 2 - (high - low) / 2 * mp.cos(mp.pi * (2 * i + 1) / (2 * count)) for i in range(count)]
    for _ in range(rounds):
        coefficients, level = solve_remez(function, weight, points, degree)

        def error(x):
            return weight(x) * (function(x) - mp.polyval(coefficients[::-1], x))

        samples = [low] + sorted(
            {a + (b - a) * k / mp.mpf(grid) for a, b in zip([low] + points, points + [high]) if b > a for k in range(grid)}
        ) + [high]
        values = [error(x) for x in samples]
        extrema, start = [], 0
        for i in range(1, len(samples) + 1):
            if i == len(samples) or values[i] * values[start] < 0:
                best = max(range(start, i), key=lambda k: abs(values[k]))
                extrema.append((samples[best], abs(values[best])))
                start = i
        while len(extrema) > count:
            extrema.pop(0 if extrema[0][1] < extrema[-1][1] else -1)
        if len(extrema) < count:
            break
        points = [x for x, _ in extrema]
        largest = max(e for _, e in extrema)
        if largest < level * mp.mpf("1.001"):
            break
    mp.mp.dps = old_dps
    return coefficients, max(abs(v) for v in values)


def fit_rounded(function, weight, low, high, degree, rounding, refit):
    """remez() with rounded coefficients, and the largest weighted error of the rounded polynomial.

    With refit they are rounded one by one, which needs low > 0.
    """
    fixed = [] if refit else [rounding(c) for c in remez(function, weight, low, high, degree)[0]]
    for step in range(len(fixed), degree + 1):

        def rest(x, fixed=tuple(fixed), step=step):
            return (function(x) - mp.polyval(list(fixed)[::-1], x)) / x**step if fixed else function(x)

        coefficients, _ = remez(rest, lambda x, step=step: weight(x) * x**step, low, high, degree - step)
        fixed.append(rounding(coefficients[0]))
    mp.mp.dps = 50
    grid = [mp.mpf(low) + (mp.mpf(high) - mp.mpf(low)) * k / 2000 for k in range(2001)]
    worst = max(abs(weight(x) * (function(x) - mp.polyval(fixed[::-1], x))) for x in grid)
    mp.mp.dps = 450
    return fixed, worst


def c_double(value):
    number = float(mp.nstr(value, 60))
    assert mp.mpf(number) == value, value
    text = number.hex()
    mantissa, exponent = text.split("p")
    mantissa = mantissa.rstrip("0").rstrip(".") if "." in mantissa else mantissa
    return f"{mantissa}p{exponent}"


def c_float(value):
    """Decimal, for GLSL knows no hexadecimal floats; nine digits name a float exactly."""
    text = f"{float(mp.nstr(value, 60)):.9g}"
    if "." not in text and "e" not in text:
        text += ".0"
    return text + "f"


# ------------------------------------------------------------------------------------------------ the polynomials
# t is the square of the argument (sin, cos, atan) or the argument itself (exp, log); the small lower limit keeps the
# series' quotient away from 0/0.

TINY = mp.mpf("1e-9")


def sin_rest(t):  # sin(r) = r + r t S(t)
    r = mp.sqrt(t)
    return (mp.sin(r) - r) / (r * t)


def cos_rest(t):  # cos(r) = 1 - t/2 + t^2 C(t)
    return (mp.cos(mp.sqrt(t)) - 1 + t / 2) / (t * t)


def atan_rest(t):  # atan(r) = r + r t A(t)
    r = mp.sqrt(t)
    return (mp.atan(r) - r) / (r * t)


def exp_rest(x):  # exp(x) = 1 + x + x^2 E(x)
    return (mp.exp(x) - 1 - x) / (x * x)


def log_rest(x):  # log(1 + x) = x - x^2/2 + x^3 L(x)
    return (mp.log(1 + x) - x + x * x / 2) / (x * x * x)


def around_zero(function, first, second, third):
    """The quotients above, by their series where they would be 0/0."""
    return lambda x: function(x) if abs(x) > mp.mpf("1e-10") else first + x * (second + x * third)


def one(_):
    return mp.mpf(1)


QUARTER = (mp.pi / 4 * mp.mpf("1.0001")) ** 2
EXP_STEPS = 64
EXP_HALF = mp.log(2) / (2 * EXP_STEPS) * mp.mpf("1.0001")
LOG_LOW, LOG_HIGH, LOG_STEPS = 90, 182, 128
LOG_HALF = mp.mpf("0.0072")

def emit_array(kind, name, comment, values, form):
    body = ", ".join(form(v) for v in values)
    print(f"/// {comment}")
    print(f"inline constexpr std::array<{kind}, {len(values)}> {name} = {{{{{body}}}}};\n")


def emit_pairs(name, comment, rows):
    print(f"/// {comment}")
    print(f"inline constexpr std::array<HighLow, {len(rows)}> {name} = {{{{")
    for high, low in rows:
        print(f"    {{{c_double(high)}, {c_double(low)}}},")
    print("}};\n")


def high_low(value):
    high = to_double(value)
    return high, to_double(value - high)


def split(value, bits, parts):
    """`parts` - 1 pieces of so many bits, and what is left as a double."""
    pieces = []
    for _ in range(parts - 1):
        pieces.append(to_bits(value, bits) if value > 0 else -to_bits(-value, bits))
        value -= pieces[-1]
    return pieces + [to_double(value)]


def emit_polynomial(name, comment, function, weight, low, high, degree, refit=False):
    fixed, worst = fit_rounded(function, weight, low, high, degree, to_double, refit)
    emit_array("double", name, f"{comment} Error below 2^{int(mp.ceil(mp.log(worst, 2)))}.", fixed, c_double)


def emit_polynomials():
    emit_polynomial("kSin", "sin(r) = r + r t S(t), t = r^2, |r| <= pi/4.", sin_rest, lambda t: t, TINY, QUARTER, 5, True)
    emit_polynomial("kCos", "cos(r) = 1 - t/2 + t^2 C(t), |r| <= pi/4.", cos_rest, lambda t: t * t, TINY, QUARTER, 5, True)
    emit_polynomial("kAtan", "atan(r) = r + r t A(t), |r| <= 1/16.", atan_rest, one, TINY, mp.mpf("0.0626") ** 2, 4)
    emit_polynomial("kExp", f"exp(r) = 1 + r + r^2 E(r), |r| <= ln(2)/{2 * EXP_STEPS}.", around_zero(exp_rest, mp.mpf(1) / 2, mp.mpf(1) / 6, mp.mpf(1) / 24), one,
                    -EXP_HALF, EXP_HALF, 4)
    emit_polynomial("kLog", "log(1 + r) = r - r^2/2 + r^3 L(r), |r| <= 0.0072.", around_zero(log_rest, mp.mpf(1) / 3, -mp.mpf(1) / 4, mp.mpf(1) / 5), one,
                    -LOG_HALF, LOG_HALF, 5)


def emit_constants():
    emit_array("double", "kHalfPiParts", "pi/2 in pieces of 36 bits and a rest: n times a piece is exact for n < 2^17.",
               split(mp.pi / 2, 36, 4), c_double)
    emit_array("double", "kLn2Parts", f"ln(2)/{EXP_STEPS} in a piece of 32 bits and a rest.",
               split(mp.log(2) / EXP_STEPS, 32, 2), c_double)
    emit_array("double", "kLn2", "ln(2) in a piece of 32 bits and a rest.", split(mp.log(2), 32, 2), c_double)
    words = int(mp.floor(2 / mp.pi * mp.mpf(2) ** (64 * 20)))
    emit_array("std::uint64_t", "kTwoOverPi", "The bits of 2/pi after the point, highest word first.",
               [(words >> (64 * (19 - i))) & (2**64 - 1) for i in range(20)], lambda w: f"0x{w:016X}U")


def emit_tables():
    emit_pairs("kAtanOfEighth", "atan(k/8), k = 0..8.", [high_low(mp.atan(mp.mpf(k) / 8)) for k in range(9)])
    emit_pairs("kExp2", f"2^(k/{EXP_STEPS}).", [high_low(mp.mpf(2) ** (mp.mpf(k) / EXP_STEPS)) for k in range(EXP_STEPS)])
    rows = []
    for j in range(LOG_LOW, LOG_HIGH + 1):
        inverse = mp.floor(mp.mpf(512) * LOG_STEPS / j + mp.mpf("0.5")) / 512
        # The high part in units of 2^-42, so that a multiple of ln(2)'s first piece adds without rounding.
        value = -mp.log(inverse)
        high = mp.nint(value * mp.mpf(2) ** 42) / mp.mpf(2) ** 42
        rows.append((inverse, high, to_double(value - high)))
    print(f"/// c, nearly {LOG_STEPS}/j with nine bits after the point, and -log(c), j = {LOG_LOW}..{LOG_HIGH}.")
    print(f"inline constexpr std::array<LogStep, {len(rows)}> kLogSteps = {{{{")
    for inverse, high, low in rows:
        print(f"    {{{c_double(inverse)}, {c_double(high)}, {c_double(low)}}},")
    print("}};\n")
    print(f"inline constexpr std::int64_t kFirstLogStep = {LOG_LOW};\n")


def float_polynomials():
    """Printed as comments for shaders/common/elementary.glsl, which is written by hand."""
    for name, function, weight in (("S", sin_rest, lambda t: t), ("C", cos_rest, lambda t: t * t)):
        fixed, worst = fit_rounded(function, weight, TINY, QUARTER, 2, to_float, True)
        print(f"// {name}: {', '.join(c_float(v) for v in fixed)} error 2^{mp.nstr(mp.log(worst, 2), 5)}")
    pieces = split(mp.pi / 2, 16, 3)
    print("// pi/2:", ", ".join(c_float(to_float(v)) for v in pieces))
    print("// 2/pi:", c_float(to_float(2 / mp.pi)))


def main():
    if sys.argv[1:] == ["--float"]:
        float_polynomials()
        return
    print("// Made by engine/core/tools/make_elementary_tables.py; not to be edited by hand (docs/numerics.md).")
    print("// clang-format off")
    print("#pragma once\n\n#include <array>\n#include <cstdint>\n\n#include \"double_double.hpp\"\n\nnamespace gdtslam::elementary {\n")
    print("struct LogStep {\n  double inverse;\n  double high;\n  double low;\n};\n")
    emit_constants()
    emit_polynomials()
    emit_tables()
    print("}  // namespace gdtslam::elementary")


if __name__ == "__main__":
    main()
