"""Names for `gymnasium.make` and `gymnasium.make_vec`: one for each map and weather."""

import importlib.util
import sys
from collections.abc import Sequence
from importlib.machinery import ModuleSpec
from types import ModuleType


def register() -> None:
    """Register the maps that come with Eyas and imported ones; importing `eyas` does it.

    If Gymnasium is not imported yet, they are registered when it is. Importing it takes 0.12 s of
    the 0.8 s of processor time of a start (Gymnasium 1.2, beyond numpy), and drawing, recording and
    the demo do without it. Its entry points for plugins would load Eyas into every program that
    imports Gymnasium where Eyas is installed, and do nothing where it is only on the path.
    """
    if "gymnasium" in sys.modules:
        # Only now: until a program that has just begun handles Ctrl-C, it should do little.
        from eyas.engine.world.maps import MAPS

        for name in (*MAPS.built_in, *MAPS.of_files()):
            register_map(name)
    elif not any(isinstance(finder, _Registrar) for finder in sys.meta_path):
        sys.meta_path.insert(0, _Registrar())


def register_map(name: str) -> None:
    """Register `eyas/<map>-<weather>-v0` for each weather of a map, unless it is registered.

    Args:
        name: Name of the map, or the path of a user's own map, as in `world.map`.

    Raises:
        ConfigError: The map does not exist.
    """
    import gymnasium

    from eyas.engine.world.maps import MAPS

    recipe = MAPS.get(name)
    for weather in recipe.weathers:
        identifier = f"eyas/{recipe.name}-{weather}-v0"
        if identifier in gymnasium.registry:
            continue
        gymnasium.register(
            id=identifier,
            entry_point="eyas.engine.envs.tracking_env:TrackingEnv",
            vector_entry_point="eyas.engine.envs.vector_env:EyasVectorEnv",
            kwargs={"map": name, "weather": weather},
        )


class _Registrar:
    """Has Gymnasium's module, once Python finds it, call `register` after its own code."""

    def find_spec(
        self, name: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Return None, and so leave the search to the other finders, for all other modules."""
        if name != "gymnasium":
            return None
        sys.meta_path.remove(self)
        spec = importlib.util.find_spec(name)
        if spec is not None and spec.loader is not None:
            execute = spec.loader.exec_module

            def execute_and_register(module: ModuleType) -> None:
                execute(module)
                register()

            spec.loader.exec_module = execute_and_register  # type: ignore[method-assign]
        return spec
