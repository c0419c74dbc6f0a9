"""The models a diagnosis went through: declared, and after every addition; what came together is one."""

from typing import NamedTuple

from jaxswarm.diagnose.report.numbers import percent
from jaxswarm.diagnose.report.text import grouped


class Stage(NamedTuple):
    """One model on the way.

    Attributes:
        name: What was added to get there.
        joint: The joint of all that was added; None: several, or the whole arm.
        before, after: Errors on unseen motion without and with it.
    """

    name: str
    joint: str | None
    before: dict | None
    after: dict


def stages(result: dict) -> list[Stage]:
    """The declared model and every model after it, in order."""
    groups: list[list[dict]] = []
    for step in result["steps"]:
        # Effects that were added together have the same model before and after them.
        same = groups and all(groups[-1][0][key] == step[key] for key in ("before", "after"))
        if same:
            groups[-1].append(step)
        else:
            groups.append([step])
    told = [Stage("declared model", None, None, result["error"]["before"])]
    for group in groups:
        added = [step["added"] for step in group]
        joints = {entry.get("joint") for entry in added}
        joint = joints.pop() if len(joints) == 1 else None
        name = f"+ {grouped(added, result['joints'])}"
        told.append(Stage(name, joint, group[0]["before"], group[0]["after"]))
    final = result["error"]["after"]
    # The numbers under the verdict are those of the last fit, of clocks and widths too.
    if groups and _shown(final) != _shown(told[-1].after):
        told.append(Stage("final model, all fitted again", None, None, final))
    return told


def _shown(errors: dict) -> str:
    return percent(errors["relative_global"])
