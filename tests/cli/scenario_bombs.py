"""Small files of every format that stand for gigabytes or for hours: each ends in one line, and is held against the most
memory and CPU time that docs/formats.md allows. bomb_formats/ has them; `ctest -V -R bombs` prints what each took."""


import cli_support as cli
from bomb_formats import bomb, logs, recordings, shapes, texts
from cli_support import expect

BOMBS = [*texts.BOMBS, *shapes.BOMBS, *logs.BOMBS, *recordings.BOMBS]


def bombs():
    """Each bomb: exit code, one line, peak memory, CPU seconds."""
    if cli.IS_SANITIZED:
        cli.skip("a sanitized program needs more time and memory")
    failed = []
    for one in BOMBS:
        code, text, megabytes, cpu_s, size = bomb.detonate(one)
        faults = bomb.faults_of(one, code, text, megabytes, cpu_s)
        print(f"{one.name}: {size} bytes, {megabytes} MB, {cpu_s:.2f} s, exit {code}: {text.strip()[:300]}")
        failed += [f"{one.name}: {fault}" for fault in faults]
    expect(not failed, "\n".join(failed))
