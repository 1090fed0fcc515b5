"""`cosim cache`."""

from __future__ import annotations

from typing import Annotated, Literal

from typer import Argument

from cosim import paths


def cache(
    action: Annotated[
        Literal["dir", "clean"], Argument(metavar="dir|clean", help="Print the folder, or empty it.")
    ],
) -> None:
    """Show or clean the cache of extracted FMUs.

    The cache is in the user's cache folder, or in the folder that COSIM_CACHE names. FMUs that
    were not used for 7 days are removed in any case.
    """
    folder = paths.cache_folder()
    if action == "dir":
        print(folder)
        return
    from cosim.fmu.cache import remove_unused

    removed = remove_unused(folder, days=0.0) if folder.is_dir() else 0
    print(f"removed {removed} extracted FMUs from {folder}")
