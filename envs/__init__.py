"""Gymnasium environments: `swamp/Gates-v0`, single and batched.

Gymnasium 1.0 dropped the entry points by which packages once announced their environments. So that
`gymnasium.make` finds this one with no other import, the wheel holds a `.pth` file that imports this
package as Python starts; hence nothing that takes time may be imported here, Gymnasium itself included.
"""

import sys
from collections.abc import Sequence
from importlib.machinery import ModuleSpec, PathFinder
from types import ModuleType

ENVIRONMENT_ID = "swamp/Gates-v0"
REGISTRY = "gymnasium.envs.registration"


def register_envs() -> None:
    """Add the environment to Gymnasium's registry, at once or as soon as Gymnasium is imported."""
    if REGISTRY in sys.modules:
        _register(sys.modules[REGISTRY])
    elif _RegistryFinder not in sys.meta_path:
        sys.meta_path.insert(0, _RegistryFinder)


def _register(registration: ModuleType) -> None:
    if ENVIRONMENT_ID not in registration.registry:
        registration.register(
            id=ENVIRONMENT_ID,
            entry_point="envs.single:GatesEnv",
            vector_entry_point="envs.batched:GatesVectorEnv",
        )


class _RegistryFinder:
    """Waits for the import of Gymnasium's registry, registers at its end, and steps aside."""

    @classmethod
    def find_spec(
        cls, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        if fullname != REGISTRY:
            return None
        sys.meta_path.remove(cls)
        spec = PathFinder.find_spec(fullname, path, target)
        if spec is None or spec.loader is None:
            return spec
        execute = spec.loader.exec_module

        def execute_and_register(module: ModuleType) -> None:
            execute(module)
            _register(module)

        setattr(spec.loader, "exec_module", execute_and_register)  # noqa: B010
        return spec


register_envs()
