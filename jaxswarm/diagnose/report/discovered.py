"""Laws that were found as formulas, as ``diagnosis.json`` has them."""

from jaxswarm.diagnose.discovery.discover import NoFormula, Search
from jaxswarm.diagnose.discovery.front import Point
from jaxswarm.diagnose.discovery.stand_ins import Discovery, Rival
from jaxswarm.diagnose.report.experiment import best_experiment
from jaxswarm.effects.dimensions import field_units, unit_text
from jaxswarm.effects.formula_file import law_name
from jaxswarm.effects.formula_text import infix, total
from jaxswarm.effects.term import Term, physical_unit
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.report.summary import term_parameters, with_intervals

# Formulas of the front that are told.
_MOST = 12
_SYMBOLS = {
    "direction": ("sign(dq_{})", r"\operatorname{{sign}}(\dot q_{{{}}})"),
    "load": ("load_{}", r"\tau_{{l,{}}}"),
    "static_load": ("load0_{}", r"\tau_{{l0,{}}}"),
    "temperature": ("T_{}", r"\vartheta_{{{}}}"),
}
_MOTION = {"q": "q_{{{}}}", "dq": r"\dot q_{{{}}}", "ddq": r"\ddot q_{{{}}}"}


def entries(search: Search, final: Estimate, joints: tuple[str, ...]) -> list[dict]:
    """One entry a discovered law."""
    return [_entry(one, final, joints) for one in search.found]


def in_vain(search: Search, joints: tuple[str, ...]) -> list[dict]:
    """Joints for which no formula was found, and why."""
    return [
        {
            "joint": joints[one.joint],
            "programs_tried": one.tried,
            "because": one.because,
            "nearest": _nearest(one, joints),
        }
        for one in search.vain
    ]


def _nearest(one: NoFormula, joints: tuple[str, ...]) -> dict | None:
    if one.nearest is None:
        return None
    return {"formula": _point_text(one.nearest), "error_on_other_motion": one.nearest.error}


def _entry(one: Discovery, final: Estimate, joints: tuple[str, ...]) -> dict:
    robot = final.model.robot
    pairs = zip(final.model.terms, final.std_errors, strict=True)
    term, errors = next((t, e) for t, e in pairs if t.identity == one.added.identity)
    plain, tex = field_names(term, joints)
    own, formula = joints[term.index], term.found_formula
    return {
        "joint": own,
        "other": None if term.other is None else joints[term.other],
        "formula": formula.text(plain),
        "latex": formula.latex(tex),
        "parameters": with_intervals(term_parameters(term, robot, errors)),
        "form": one.chosen.symmetry.text,
        "based_on": list(one.based_on),
        "range": _range(term, final, joints),
        "gain": {
            "share_of_error": one.score.share,
            "p_value": one.score.p_value,
            "helps_in_blocks": one.score.repeats,
        },
        "error_on_other_motion": one.chosen.error,
        "programs_tried": one.tried,
        "front": [
            {"formula": _point_text(p), "bits": p.bits, "error_on_other_motion": p.error}
            for p in one.front[:_MOST]
        ],
        "alternatives": [_alternative(one, rival, joints) for rival in one.rivals],
        "file": f"{law_name(own)}.py",
        "picture": f"{law_name(own)}.png",
    }


def field_names(term: Term, joints: tuple[str, ...]) -> tuple[dict[str, str], dict[str, str]]:
    """What the fields of a formula are called on its joint: as text, and in LaTeX."""
    own = joints[term.index]
    plain = {name: f"{name}_{own}" for name in _MOTION}
    plain |= {name: text.format(own) for name, (text, _) in _SYMBOLS.items()}
    tex = {name: text.format(_index(own)) for name, text in _MOTION.items()}
    tex |= {name: text.format(_index(own)) for name, (_, text) in _SYMBOLS.items()}
    if term.other is not None:
        partner = joints[term.other]
        plain |= {f"{name}_other": f"{name}_{partner}" for name in _MOTION}
        tex |= {f"{name}_other": text.format(_index(partner)) for name, text in _MOTION.items()}
    return plain, tex


def _index(joint: str) -> str:
    escaped = joint.replace("\\", "").replace("_", r"\_")
    return rf"\mathrm{{{escaped}}}"


def _point_text(point: Point) -> str:
    linear = [f"a{k + 1}" for k in range(len(point.formula.programs))]
    return total([infix(p) for p in point.formula.programs], linear)


def _range(term: Term, final: Estimate, joints: tuple[str, ...]) -> list[dict]:
    """Where the law was seen."""
    kinds = final.model.robot.kinds
    units = field_units(kinds[term.index], None if term.other is None else kinds[term.other])
    plain, _ = field_names(term, joints)
    return [
        {
            "variable": plain.get(name, name),
            "from": low,
            "to": high,
            "unit": physical_unit(unit_text(units[name]), kinds[term.index]),
        }
        for name, low, high in term.found_formula.valid
    ]


def _alternative(one: Discovery, rival: Rival, joints: tuple[str, ...]) -> dict:
    """A formula that fits alike: how far it is from the chosen one, and the motion that would tell."""
    plain, tex = field_names(rival.term, joints)
    trial = best_experiment(one.after.model, rival.model, one.after.motions[0], rival.term.joint)
    return {
        "formula": rival.term.found_formula.text(plain),
        "latex": rival.term.found_formula.latex(tex),
        "error_on_other_motion": rival.point.error,
        "distance": {"rms": rival.rms, "over_noise": rival.over_noise},
        "experiment": trial.words(joints),
    }
