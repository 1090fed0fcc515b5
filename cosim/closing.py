"""Base class of objects that hold open resources: `with` closes them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Self


class Closing(ABC):
    """Base class of objects that close when their `with` block ends, also after an error."""

    @abstractmethod
    def close(self) -> None:
        """Release the open resources."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
