#!/usr/bin/env python3
"""Scores what `trainer init LOG --json` says of the logs that make.py made.

    VENV/bin/python experiments/logs/score.py OUT --trainer target/release/trainer [--kind headers] [--next]

Two logs at a time. Prints a table by kind and one line for every log that is not ok; writes OUT/score.json.
"""

import argparse
import collections
import json
import shlex
import shutil
import statistics
import subprocess
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

VERDICTS = ["ok", "near", "noted", "silent", "message", "crash"]
LIMIT_S = 60


def call(command, folder=None):
    """Exit code (None after the time limit), standard output, standard error."""
    try:
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, errors="replace", timeout=LIMIT_S)
        return done.returncode, done.stdout, done.stderr
    except subprocess.TimeoutExpired:
        return None, "", f"no end within {LIMIT_S} s"


def numbers(answer):
    """The oscillators of an answer: its modes if it lists some, and the one it names first."""
    main = answer.get("oscillator") or {}
    return [m for m in [main, *(main.get("modes") or answer.get("modes") or [])] if m]


def read(mode, *keys):
    """Value and standard error of the first key that the mode has."""
    for key in keys:
        found = mode.get(key)
        if isinstance(found, dict) and found.get("value") is not None:
            low, high = found.get("interval_95") or (0.0, 0.0)
            return found["value"], found.get("std_error") or (high - low) / 3.92
        if isinstance(found, (int, float)):
            return found, 0.0
    return None


def compare(mode, true, best):
    """How far one oscillator of the answer is from the truth; `best` holds the standard errors that the samples allow."""
    f, z = read(mode, "natural_frequency_hz", "frequency_hz"), read(mode, "damping_ratio")
    if f is None or z is None:
        return None
    df, dz = abs(f[0] - true["frequency_hz"]), abs(z[0] - true["damping_ratio"])
    rf, rz = df / true["frequency_hz"], dz / true["damping_ratio"]
    return {"frequency_hz": f[0], "frequency_se": f[1], "damping_ratio": z[0], "damping_se": z[1], "off_f": rf, "off_z": rz,
            "within_se": df <= 3 * f[1] and dz <= 3 * z[1], "within_percent": rf <= 0.005 and rz <= 0.03,
            "right": (df <= 3 * f[1] or rf <= 0.005) and (dz <= 3 * z[1] or rz <= 0.03),
            "far": rf > 0.02 or (rz > 0.1 and dz > 3 * z[1]),
            # Right only because the standard errors are large, five times those that the samples allow or more.
            "vague": f[1] > max(0.05 * true["frequency_hz"], 5 * best["frequency_hz"]) or z[1] > max(0.5 * true["damping_ratio"], 5 * best["damping_ratio"]),
            "wide": z[1] / best["damping_ratio"]}


def notes(answer):
    """What the answer remarks, of the record and of every log in a folder."""
    found = list((answer.get("record") or {}).get("findings") or [])
    for log in answer.get("logs") or []:
        found += (log.get("findings") or (log.get("record") or {}).get("findings") or []) if isinstance(log, dict) else []
    return [n if isinstance(n, str) else json.dumps(n, ensure_ascii=False) for n in found]


def judge(code, out, err, truth):
    """Verdict, what to print of it, and the comparison."""
    if code == 2:
        lines = [line for line in err.splitlines() if line.strip()]
        one = sum(line.startswith("error") for line in lines) == 1 and "panicked" not in err
        return ("message" if one else "crash"), " / ".join(lines)[:400], None
    try:
        answer = json.loads(out) if code == 0 else None
    except json.JSONDecodeError:
        answer = None
    if answer is None:
        return "crash", f"exit {code}: " + " / ".join(err.split("\n"))[:300], None
    true = truth.get("modes") or [truth]
    tried = [c for mode in numbers(answer) for c in [compare(mode, t, truth["attainable_se"]) for t in true] if c]
    said = notes(answer)
    if not tried:
        return ("noted" if said else "silent"), "no frequency or no damping; " + "; ".join(said), None
    best = min(tried, key=lambda c: (not c["right"], c["far"], c["off_f"]))
    best["modes_found"] = sum(any(c and c["right"] for c in (compare(m, t, truth["attainable_se"]) for m in numbers(answer))) for t in true)
    text = (f"f {best['frequency_hz']:.5g} ± {best['frequency_se']:.2g} ({100 * best['off_f']:.2g} % off), "
            f"ζ {best['damping_ratio']:.4g} ± {best['damping_se']:.2g} ({100 * best['off_z']:.2g} % off)")
    column = ((answer.get("record") or {}).get("reading") or {}).get("value") or {}
    text += f"; value {column.get('column')!r}" + "".join(f"; note: {n}" for n in said)
    if best["right"]:
        return "ok", text, best
    return ("noted" if said else "silent" if best["far"] else "near"), text, best


def follow(out, trainer, folder):
    """Exit codes of the commands that the answer proposes."""
    try:
        commands = json.loads(out).get("next") or []
    except json.JSONDecodeError:
        return []
    codes = []
    for command in commands:
        words = shlex.split(command)
        words[0] = str(trainer)
        code, _, err = call([*words, "--json"], folder)
        kind = words[1] if not words[1].endswith(".toml") else "estimate"
        codes.append({"command": kind, "exit": code, "message": next((e for e in err.splitlines() if e.startswith("error")), "")})
    return codes


def score(chosen, path):
    truth = json.loads(path.read_text())
    folder = Path(tempfile.mkdtemp(prefix="logs-score-"))
    command = [str(chosen.trainer), "init", str((chosen.out / "logs" / truth["log"]).resolve()), "--json", "--out", str(folder / "init")]
    code, out, err = call(command + truth["options"], folder)
    verdict, text, best = judge(code, out, err, truth)
    after = follow(out, chosen.trainer, folder) if chosen.next and code == 0 else []
    shutil.rmtree(folder, ignore_errors=True)
    return {"number": path.stem, "kind": truth["kind"], "variant": truth["variant"], "log": truth["log"], "options": truth["options"],
            "verdict": verdict, "allowed": verdict == "message" and truth["accept"] != "number", "exit": code, "text": text,
            "true_frequency_hz": truth["frequency_hz"], "true_damping_ratio": truth["damping_ratio"],
            "modes": len(truth.get("modes", [])), "answer": best, "next": after}


def row(name, results):
    """The figures of one line of the table."""
    count = collections.Counter(r["verdict"] for r in results)
    answers = [r["answer"] for r in results if r["answer"]]
    share = lambda key: f"{100 * sum(a[key] for a in answers) / len(answers):.0f} %" if answers else "-"
    vague = sum(r["verdict"] == "ok" and r["answer"]["vague"] for r in results)
    return [name, len(results), *(count[v] for v in VERDICTS), sum(r["allowed"] for r in results), vague, share("within_se"), share("within_percent"),
            f"{statistics.median(a['wide'] for a in answers):.1f}" if answers else "-"]


def show(lines):
    """Prints columns of equal width."""
    lines = [[str(cell) for cell in line] for line in lines]
    widths = [max(map(len, column)) for column in zip(*lines)]
    for line in lines:
        print("  ".join([line[0].ljust(widths[0]), *(c.rjust(w) for c, w in zip(line[1:], widths[1:]))]).rstrip())


def report(results, full, codes):
    head = ["n", *VERDICTS, "allowed", "vague", "in 3 se", "in 0.5/3 %", "se ratio"]
    kinds = list(dict.fromkeys(r["kind"] for r in results))
    group = lambda key, value, among: [r for r in among if r[key] == value]
    show([["kind", *head], *(row(k, group("kind", k, results)) for k in kinds), row("all", results)])
    print()
    lines = [["variant", *head]]
    for kind in kinds:
        some = group("kind", kind, results)
        lines += [row(f"{kind}/{v}", group("variant", v, some)) for v in sorted({r["variant"] for r in some})]
    show(lines)
    two = [r for r in results if r["modes"]]
    if two:
        found = sum((r["answer"] or {}).get("modes_found", 0) for r in two)
        print(f"\nmodes found: {found} of {sum(r['modes'] for r in two)}")
    if codes:
        print("\ncommands in `next` (exit None: no end within the limit):")
        count = collections.Counter((c["command"], c["exit"]) for r in results for c in r["next"])
        show([["command", "exit", "n"], *([a, b, n] for (a, b), n in sorted(count.items(), key=str))])
        for r in results:
            for c in r["next"]:
                if c["exit"] not in (0,):
                    print(f"{r['number']} {r['kind']}/{r['variant']} {c['command']} exit {c['exit']}: {c['message']}"[: None if full else 220])
    print("\nnot ok, and vague: right only because of large standard errors:")
    for r in sorted(results, key=lambda r: (kinds.index(r["kind"]), r["variant"], r["number"])):
        vague = r["verdict"] == "ok" and r["answer"]["vague"]
        if r["verdict"] != "ok" or vague:
            asked = f" (true f {r['true_frequency_hz']:.5g}, ζ {r['true_damping_ratio']:.4g})" if r["answer"] else ""
            print(f"{r['number']} {r['kind']}/{r['variant']:<14} {'vague' if vague else r['verdict']:<7} {r['text']}{asked}"[: None if full else 260])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", type=Path)
    parser.add_argument("--trainer", type=Path, required=True)
    parser.add_argument("--kind", help="one kind, or kind/variant")
    parser.add_argument("--next", action="store_true", help="also runs the commands that the answer proposes")
    parser.add_argument("--full", action="store_true", help="prints whole lines")
    parser.add_argument("--gate", action="store_true", help="exit code 1 where a log is wrong in silence, has no message of its own, or fewer than "
                        "95 %% are within three standard errors")
    chosen = parser.parse_args()
    chosen.trainer = chosen.trainer.resolve()
    paths = []
    for path in sorted((chosen.out / "truth").glob("*.json")):
        truth = json.loads(path.read_text())
        if not chosen.kind or chosen.kind in (truth["kind"], f"{truth['kind']}/{truth['variant']}"):
            paths.append(path)
    with ThreadPoolExecutor(2) as pool:
        results = list(pool.map(lambda path: score(chosen, path), paths))
    report(results, chosen.full, chosen.next)
    (chosen.out / "score.json").write_text(json.dumps(results, indent=1, ensure_ascii=False) + "\n")
    # A magnitude swings at twice the frequency of its motion; a remark is all that it allows.
    within = [r["answer"]["within_se"] for r in results if r["answer"] and r["variant"] not in ("magnitude", "rectified")]
    failed = any(r["verdict"] in ("silent", "crash") for r in results) or sum(within) < 0.95 * len(within)
    return 1 if chosen.gate and failed else 0


if __name__ == "__main__":
    raise SystemExit(main())
