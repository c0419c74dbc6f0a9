"""What there is: ``effects`` and ``optimizers``."""

import typer

from jaxswarm import console
from jaxswarm.commands.options import Json
from jaxswarm.runtime import start


def register(app: typer.Typer) -> None:
    """Add the commands of this group."""

    @app.command(epilog="Example: jaxswarm effects --json")
    def effects(json: Json = False) -> None:
        """List the effects: what can be declared and what is asked of a residual."""
        start()
        from jaxswarm.effects import REGISTRY

        rows = [
            {
                "effect": law.name,
                "scope": law.scope,
                "law": law.summary,
                "parameters": {
                    p.name: {"unit": p.unit, "lower": p.lower, "upper": p.upper, "linear": p.linear}
                    for p in law.parameters
                },
                "reference": law.reference,
            }
            for law in sorted(REGISTRY.values(), key=lambda law: law.name)
        ]
        console.table(rows, json, ("effect", "scope", "law", "reference"))

    @app.command(epilog="Example: jaxswarm optimizers --json")
    def optimizers(json: Json = False) -> None:
        """List the optimizers and the papers they come from."""
        start()
        from jaxswarm.swarm import OPTIMIZERS

        rows = [
            {
                "optimizer": name,
                "about": entry.description,
                "reference": entry.reference,
                "reconstruction": entry.reconstruction,
            }
            for name, entry in OPTIMIZERS.items()
        ]
        console.table(rows, json, ("optimizer", "about", "reference"))
