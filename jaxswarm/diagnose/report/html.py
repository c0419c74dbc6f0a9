"""The report as one self-contained HTML page: the verdict first, what it rests on below."""

from html import escape

from jaxswarm.diagnose.report import appendix, findings
from jaxswarm.diagnose.report.signals import Signals
from jaxswarm.diagnose.report.style import STYLE


def render(
    result: dict,
    images: dict[str, bytes],
    shown: Signals | None = None,
    model: str | None = None,
) -> str:
    """The page for the content of ``diagnosis.json`` and its pictures (PNG bytes by file name).

    Nothing on it is fetched from elsewhere, and without scripts it says the same: the only program zooms
    into signals. Pictures that were not drawn are left out.

    Args:
        result: The diagnosis.
        images: Pictures by name.
        shown: Torque over time to be zoomed into; None: as a picture.
        model: Content of ``model.json``, to be saved from the page; None: there is none.
    """
    sections = [
        findings.verdict(result),
        findings.errors(result, images),
        findings.doubts(result),
        findings.effects(result, images),
        findings.left(result, images),
        findings.todo(result),
        appendix.not_added(result),
        appendix.rigid_body(result),
        appendix.pictures(result, images, shown),
        appendix.logs(result),
        appendix.origin(result, model),
    ]
    title = escape(f"{result['robot']}: {result['verdict']} - jaxswarm")
    # Without an icon of its own a browser asks the folder for one, and tells that there is none.
    return (
        '<!doctype html><html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width,initial-scale=1">'
        f'<link rel="icon" href="data:,"><title>{title}</title><style>{STYLE}</style></head>'
        f"<body><main>{''.join(sections)}</main></body></html>\n"
    )
