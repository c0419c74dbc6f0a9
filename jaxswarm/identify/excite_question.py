"""What a motion is planned for: all parameters of a model, or two effects that are to be told apart."""

import numpy as np

from jaxswarm.effects.friction import USUAL_FRICTION
from jaxswarm.effects.term import Term, parse_terms
from jaxswarm.errors import InputError
from jaxswarm.identify.excitation.columns import plannable, refuse_terms
from jaxswarm.identify.excitation.separation import Question
from jaxswarm.identify.forward.model import Model
from jaxswarm.robot.model import Robot


def question_of(
    robot: Robot, effects: str | None, separate: str | None, given: Model | None
) -> tuple[Question | None, tuple[Term, ...], list[str]]:
    """What is to be told apart, all effects of the motion, and those of a model that have no columns.

    Raises:
        InputError: If the effects are not two, cannot be planned for, or do not fit to the model.
    """
    joints = robot.joints
    if separate is None:
        if effects is None and given is not None:
            possible = tuple(t for t in given.terms if plannable(t, joints, True))
            return None, possible, [t.label(joints) for t in given.terms if t not in possible]
        return None, parse_terms(USUAL_FRICTION if effects is None else effects, joints), []
    pair = parse_terms(separate, joints)
    if len(pair) != 2:
        raise InputError(
            f"--separate {separate}: names {len(pair)} effects on joints; exactly two are needed, as "
            "effect@joint,effect@joint"
        )
    if given is None:
        others = parse_terms(USUAL_FRICTION if effects is None else effects, joints)
        kept = tuple(t for t in others if t not in pair)
        refuse_terms(pair, joints, option="--separate")
        return Question(pair, kept), (*kept, *pair), []
    if effects is not None:
        raise InputError("--effects and --given both say what the model holds; give one of them")
    refuse_terms(pair, joints, True, "--separate")
    known = {term: term for term in given.terms}
    others = tuple(term for term in given.terms if term not in pair)
    kept = tuple(term for term in others if plannable(term, joints, True))
    pair = (known.get(pair[0], pair[0]), known.get(pair[1], pair[1]))
    pi = np.asarray(given.robot.parameters).ravel()
    noise = np.asarray(given.sigma)
    usable = noise.shape == (len(joints),) and (noise > 0).all() and np.isfinite(noise).all()
    question = Question(pair, kept, pi, noise if usable else None)
    return question, (*kept, *pair), [t.label(joints) for t in others if t not in kept]
