"""The SEPSO study's page: where the paper's claim holds, then tables and pictures."""

from jaxswarm.studies import page


def verdict_lines(result: dict) -> list[str]:
    """The findings in sentences made from the numbers."""
    texts = []
    settings = len(result["sections"])
    variants = dict.fromkeys(c["sepso"] for s in result["sections"] for c in s["comparisons"])
    for variant in variants:
        for rival in ("SPSO", "GA"):
            told = [
                c["sepso_is"]
                for s in result["sections"]
                for c in s["comparisons"]
                if (c["sepso"], c["rival"], c["on"]) == (variant, rival, "accuracy")
            ]
            counts = ", ".join(
                f"{word} in {told.count(word)}" for word in ("better", "worse", "not told apart")
            )
            texts.append(
                f"{variant} [reconstruction] against {rival}, parameter accuracy over {settings} settings: "
                f"{counts}."
            )
    holds = [
        f"{variant} on {s['plant']}, {s['case']}, {s['budget']}"
        for variant in variants
        for s in result["sections"]
        if all(
            c["sepso_is"] == "better"
            for c in s["comparisons"]
            if (c["sepso"], c["on"]) == (variant, "accuracy") and c["rival"] in ("SPSO", "GA")
        )
    ]
    texts.append(
        "The paper's claim, SEPSO more accurate than SPSO and than GA, holds for: "
        f"{'; '.join(holds) or 'none of these settings'}."
    )
    clean = [s for s in result["sections"] if s["case"] == "clean"]
    worst = max(s["polish"]["accuracy_best"] for s in clean)
    texts.append(
        "Levenberg-Marquardt from the ends of SPSO's runs: on clean outputs its best has parameter errors "
        f"of at most {worst:.1e} of the ranges."
    )
    exact = max(t["least_squares_error"] for t in result["torque_error"])
    texts.append(
        f"With torque error and perfect accelerations least squares is exact ({exact:.0e} of the ranges): "
        "such a problem separates no algorithms worth separating."
    )
    return texts


def render(result: dict, images: dict[str, bytes]) -> str:
    """The page for the content of ``sepso.json`` and its pictures."""
    parts = [page.verdicts(result["findings"]), page.reconstructions(result["reconstructions"])]
    names = {p["name"]: p for p in result["plants"]}
    for s in result["sections"]:
        plant = names[s["plant"]]
        title = f"{s['plant']}, {s['case']} output, {s['budget']} budget"
        picture = f"convergence_{s['plant']}_{s['case']}_{s['budget']}.png".replace(" ", "_")
        polish = s["polish"]
        parts += [
            page.heading(f"{title}: {s['evaluations']} evaluations, {s['runs']} runs"),
            _accuracy(s["rows"], plant, s["cost_of_truth"]),
            page.sentence(
                f"Levenberg-Marquardt from {polish['starts']} of SPSO's ends: median cost "
                f"{polish['cost_before_median']:.2g} becomes {polish['cost_median']:.2g}; best "
                f"{polish['cost_best']:.2g} with accuracy {polish['accuracy_best']:.2g}."
            ),
            _comparisons(s["comparisons"]),
            page.picture(picture, images[picture]),
        ]
    for t in result["torque_error"]:
        parts += [
            page.heading(f"Torque error, {t['plant']}: {t['evaluations']} evaluations"),
            page.sentence(
                f"Least squares: {', '.join(page.number(x, 6) for x in t['least_squares'])}, cost "
                f"{t['least_squares_cost']:.1e}."
            ),
            _accuracy(t["rows"], names[t["plant"]], 0.0),
            *([_comparisons(t["comparisons"])] if t["comparisons"] else []),
        ]
    return page.page("SEPSO: output error of two manipulators", parts)


def _accuracy(rows, plant, truth):
    head = ["optimizer", *(f"{n}: mean" for n in plant["names"])]
    head += [*(f"{n}: std" for n in plant["names"]), "accuracy", "median cost", "worst cost"]
    body = [["true", *plant["true"], *([None] * 4), None, truth, None]]
    for r in rows:
        label = r["optimizer"] + (" [reconstruction]" if r["reconstruction"] else "")
        body.append(
            [label, *r["mean"], *r["std"], r["accuracy_median"], r["cost_median"], r["cost_max"]]
        )
    return page.table(head, body)


def _comparisons(rows):
    head = ["SEPSO variant (reconstruction)", "rival", "on", "A12", "Holm p", "SEPSO is"]
    keys = ("sepso", "rival", "on", "effect", "p_holm", "sepso_is")
    return page.table(head, [[r[k] for k in keys] for r in rows])
