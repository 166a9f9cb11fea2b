#!/usr/bin/env python3
"""Prints the expected numbers of random_test.cpp, from the published algorithms and in Python's integers alone.

Checks itself first against two published sequences: splitmix64 of the seed 1234567 and xoshiro256** of the state
(1, 2, 3, 4). Needs mpmath for the logarithm of the normal draws.
"""
import mpmath as mp

MASK = 2**64 - 1


def splitmix64(state):
    state = (state + 0x9E3779B97F4A7C15) & MASK
    z = state
    z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & MASK
    z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & MASK
    return state, z ^ (z >> 31)


def rotate_left(x, k):
    return ((x << k) | (x >> (64 - k))) & MASK


class Xoshiro256StarStar:
    def __init__(self, state):
        self.s = list(state)

    @classmethod
    def seeded(cls, seed):
        words = []
        for _ in range(4):
            seed, word = splitmix64(seed)
            words.append(word)
        return cls(words)

    def bits(self):
        s = self.s
        result = (rotate_left((s[1] * 5) & MASK, 7) * 9) & MASK
        t = (s[1] << 17) & MASK
        s[2] ^= s[0]
        s[3] ^= s[1]
        s[1] ^= s[2]
        s[0] ^= s[3]
        s[2] ^= t
        s[3] = rotate_left(s[3], 45)
        return result

    def uniform(self):
        return (self.bits() >> 11) * 2.0**-53


def normals(generator, count):
    """Marsaglia's polar method in exact arithmetic, rounded once at the end."""
    mp.mp.dps = 60
    draws = []
    while len(draws) < count:
        u, v = (2 * mp.mpf(generator.uniform()) - 1 for _ in range(2))
        square = u * u + v * v
        if 0 < square < 1:
            scale = mp.sqrt(-2 * mp.log(square) / square)
            draws += [u * scale, v * scale]
    return draws[:count]


def main():
    state, published = 1234567, []
    for _ in range(5):
        state, word = splitmix64(state)
        published.append(word)
    assert published == [6457827717110365317, 3203168211198807973, 9817491932198370423, 4593380528125082431,
                         16408922859458223821]
    generator = Xoshiro256StarStar([1, 2, 3, 4])
    assert [generator.bits() for _ in range(5)] == [11520, 0, 1509978240, 1215971899390074240, 1216172134540287360]

    generator = Xoshiro256StarStar.seeded(1)
    print("bits, seed 1:", ", ".join(f"0x{generator.bits():016X}U" for _ in range(8)))
    for _ in range(991):
        generator.bits()
    print("the 1000th:", f"0x{generator.bits():016X}U")
    print("bits, seed 0:", f"0x{Xoshiro256StarStar.seeded(0).bits():016X}U")
    print("bits, seed 2^64 - 1:", f"0x{Xoshiro256StarStar.seeded(MASK).bits():016X}U")
    generator = Xoshiro256StarStar.seeded(1)
    print("uniform, seed 1:", ", ".join(generator.uniform().hex() for _ in range(4)))
    generator = Xoshiro256StarStar.seeded(1)
    print("normal, seed 1:", ", ".join(mp.nstr(x, 17) for x in normals(generator, 6)))
    _, mixed = splitmix64(1)
    _, seed = splitmix64(mixed ^ 7)
    print("split(7) of seed 1:", f"0x{Xoshiro256StarStar.seeded(seed).bits():016X}U")


if __name__ == "__main__":
    main()
