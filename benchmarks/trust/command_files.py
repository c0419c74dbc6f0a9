"""The files of one command: right ones and spoiled ones."""

from pathlib import Path

import numpy as np

from benchmarks.trust import good, targets


class Files:
    """Right and spoiled files of one command in a folder; ``spoiled`` is the share of these."""

    def __init__(self, rng: np.random.Generator, folder: Path, spoiled: float):
        self.rng, self.folder, self.spoiled, self.count = rng, folder, spoiled, 0

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
        if self.rng.random() < self.spoiled:
            return self._spoiled(("CSV", "NPZ", "MAT", "Parquet", "MCAP", "HDF5"))
        return good.write_csv(self.folder / "right.csv", good.columns())

    def robot(self) -> Path:
        if self.rng.random() < 0.6 * self.spoiled:
            return self._spoiled(("URDF", "MJCF", "SDF", "TOML"))
        return self._right("arm.toml", good.TOML)

    def model(self) -> Path:
        if self.rng.random() < self.spoiled:
            return self._spoiled(("model.json",))
        return self._right("model.json", good.model_json())

    def limits(self) -> Path:
        if self.rng.random() < self.spoiled:
            return self._spoiled(("limits",))
        return self._right("limits.toml", good.LIMITS)

    def logs(self) -> Path:
        """A folder with the logs of two arms."""
        place = self.folder / "logs"
        for arm in ("a1", "a2"):
            (place / arm).mkdir(parents=True)
            log = self.log()
            (place / arm / f"2026-01-05{log.suffix}").write_bytes(log.read_bytes())
        return place
