"""The files of one command: right ones and spoiled ones."""

from pathlib import Path

import numpy as np

from benchmarks.trust import good, targets

# Share of files that are spoiled.
_SPOILED = 0.5


class Files:
    """Right and spoiled files of one command in a folder."""

    def __init__(self, rng: np.random.Generator, folder: Path):
        self.rng, self.folder, self.count = rng, folder, 0

    def _spoiled(self, names: tuple[str, ...]) -> Path:
        self.count += 1
        place = self.folder / f"f{self.count}"
        place.mkdir()
        name = names[self.rng.integers(len(names))]
        targets.TARGETS[name](self.rng, place)
        files = [p for p in place.rglob("*") if p.is_file() and p.name != "metadata.yaml"]
        return sorted(files)[0]

    def _right(self, name: str, text: str) -> Path:
        path = self.folder / name
        path.write_text(text)
        return path

    def log(self) -> Path:
        if self.rng.random() < _SPOILED:
            return self._spoiled(("CSV", "NPZ", "MAT", "Parquet", "MCAP"))
        return good.write_csv(self.folder / "right.csv", good.columns())

    def robot(self) -> Path:
        if self.rng.random() < 0.3:
            return self._spoiled(("URDF", "MJCF", "TOML"))
        return self._right("arm.toml", good.TOML)

    def model(self) -> Path:
        if self.rng.random() < _SPOILED:
            return self._spoiled(("model.json",))
        return self._right("model.json", good.model_json())

    def limits(self) -> Path:
        if self.rng.random() < _SPOILED:
            return self._spoiled(("limits",))
        return self._right("limits.toml", good.LIMITS)
