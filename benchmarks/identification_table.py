"""Rows of the identification benchmark as tables."""


def markdown(rows: list[dict]) -> str:
    """A table of the plain values; errors of parameters and the last row's values follow."""
    keys = [k for k, v in rows[0].items() if not isinstance(v, dict)]

    def cell(value):
        if isinstance(value, list):
            return " / ".join(f"{x:.2f}" for x in value)
        return f"{value:.4g}" if isinstance(value, float) else str(value)

    lines = ["| " + " | ".join(keys) + " |", "|" + "---|" * len(keys)]
    lines += ["| " + " | ".join(cell(row[k]) for k in keys) + " |" for row in rows]
    if "errors" in rows[0]:
        heads = [f"{row['setting']}, {row['method']}" for row in rows]
        lines += ["", "| error of | " + " | ".join(heads) + " |", "|---|" + "---|" * len(rows)]
        for name in rows[0]["errors"]:
            cells = " | ".join(f"{row['errors'][name]:.2e}" for row in rows)
            lines.append(f"| {name} | {cells} |")
    if "values" in rows[-1]:
        lines += ["", f"Values, {rows[-1]['effects']}:", ""]
        for label, values in rows[-1]["values"].items():
            lines.append(f"- {label}: " + ", ".join(f"{k} {v:.4g}" for k, v in values.items()))
        rigid = {k: v for k, v in rows[-1]["base"].items() if len(rows[-1]["base"]) < 10}
        lines += [f"- {name}: {value:.5g}" for name, value in rigid.items()]
    return "\n".join(lines)
