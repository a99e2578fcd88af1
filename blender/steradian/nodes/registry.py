"""Which function evaluates which kind of node: values, surfaces and volumes."""

from __future__ import annotations

VALUES: dict = {}
SURFACES: dict = {}
VOLUMES: dict = {}


def _registering(table):
    def decorator(*kinds):
        def keep(function):
            for kind in kinds:
                table[kind] = function
            return function

        return keep

    return decorator


evaluates = _registering(VALUES)
scatters = _registering(SURFACES)
fills = _registering(VOLUMES)
