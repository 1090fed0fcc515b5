"""Elements by name; the error for an unknown name shows the closest one."""

import contextlib
import difflib
from collections.abc import Iterable, Iterator
from types import ModuleType
from typing import Any

MJCF_ELEMENTS = {
    "body": "bodies", "equality": "equalities", "mesh": "meshes",
    **{name: f"{name}s" for name in (
        "actuator", "camera", "exclude", "frame", "geom", "hfield", "joint", "key", "light", "material",
        "numeric", "pair", "sensor", "site", "tendon", "text", "texture", "tuple",
    )},
}  # fmt: skip
"""Methods of `mujoco.MjSpec` that find an element by name, and its lists of elements."""


class UnknownNameError(LookupError):
    """The name is unknown."""


def unknown(thing: str, name: str, choices: Iterable[str], otherwise: str = "") -> UnknownNameError:
    """Error of an unknown name.

    Parameters
    ----------
    thing : str
        Kind and location of the object.
    otherwise : str
        Additional hint if the name is correct.
    """
    known = sorted(set(choices))
    near = difflib.get_close_matches(name, known, n=1)
    listed = f"Known names: `{'`, `'.join(known)}`." if known else ""
    hint = " ".join(filter(None, (f"Use `{near[0]}`." if near else listed, otherwise)))
    return UnknownNameError(f"there is no {thing} `{name}`" + (f"\nhint: {hint}" if hint else ""))


@contextlib.contextmanager
def native_names(native: ModuleType) -> Iterator[None]:
    """Error of an element that the native module lacks."""
    try:
        yield
    except AttributeError as error:
        if error.obj is not native:
            raise
        elements = (key for key in dir(native) if key[0].islower())
        new = "Build a new one with `cargo xtask setup`."
        raise unknown("native element", str(error.name), elements, new) from error


class Mjcf:
    """A `mujoco.MjSpec` with required elements: `spec.body("rotr")` is an error, not None.

    Parameters
    ----------
    spec : mujoco.MjSpec
        The specification; all other calls are passed to it.
    file : str
        Name of its file, for messages.
    """

    def __init__(self, spec: Any, file: str) -> None:
        # not by `self.spec = `, which goes to the spec
        self.__dict__.update(spec=spec, file=file)

    def __getattr__(self, name: str) -> Any:
        found = getattr(self.spec, name)
        return self._finder(name, found) if name in MJCF_ELEMENTS else found

    def __setattr__(self, name: str, value: object) -> None:
        setattr(self.spec, name, value)

    def _finder(self, thing: str, find: Any) -> Any:
        def found(name: str) -> Any:
            element = find(name)
            if element is None:
                choices = (element.name for element in getattr(self.spec, MJCF_ELEMENTS[thing]))
                raise unknown(f"{thing} in `{self.file}` named", name, filter(None, choices))
            return element

        return found
