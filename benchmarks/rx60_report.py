"""The times of the RX60 benchmark side by side."""


def report(rows: list[dict], targets: dict, total: int) -> None:
    """Print the times, how often ours fits into each peer's, and the targets; of a total of runs."""
    ours = [r for r in rows if r["name"] == "jaxswarm"]
    warm = ours[0]["warm"]
    cold = {r["kind"]: r["cold"] for r in ours}
    widths = {"runs": 6, "warm s": 9, "CPU s": 9, "cold s": 9, "warm x": 9, "CPU x": 8}
    widths |= {"cold x": 9, "cached x": 10}
    print(" " * 26 + "".join(f"{name:>{width}}" for name, width in widths.items()))
    for r in rows:
        if "missing" in r:
            print(f"{r['name']:<26} {r['missing']}")
            continue
        label = f"{r['name']}, {r['kind']}" if r["name"] == "jaxswarm" else r["name"]
        ratios = (
            r["warm"] / warm,
            r["warm_cpu"] / ours[0]["warm_cpu"],
            r["cold"] / cold["cold"],
            r["cold"] / cold["cold, cached"],
        )
        print(
            f"{label:<26}{r['runs']:>6}{r['warm']:>9.3f}{r['warm_cpu']:>9.3f}{r['cold']:>9.2f}"
            f"{ratios[0]:>9.1f}{ratios[1]:>8.1f}{ratios[2]:>9.2f}{ratios[3]:>10.2f}"
        )
    print("targets (warm, cold):", targets)
    print(f"runs: how many of the {total} were run; the rest is extrapolated")
    print("cold is bounded by importing JAX and compiling two programs, one for each scheme;")
    print("with a filled compile cache, by importing and tracing them")
