"""Following the links of a node tree: through reroutes, muted nodes and groups."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Optional


@dataclass(frozen=True)
class Source:
    """Where a socket's value comes from: an output of a node, or (without one) the socket's own value."""

    socket: Any
    groups: tuple = ()
    node: Any = None

    @property
    def is_linked(self) -> bool:
        return self.node is not None


def _live_link(socket):
    """The link that feeds an input, if any counts."""
    return next((link for link in socket.links if link.is_valid and not link.is_muted), None)


def _group_output(tree):
    outputs = [n for n in tree.nodes if n.bl_idname == "NodeGroupOutput"]
    return next((n for n in outputs if n.is_active_output), outputs[0] if outputs else None)


def _by_identifier(sockets, identifier):
    return next((s for s in sockets if s.identifier == identifier), None)


def source(socket, groups: tuple = ()) -> Optional[Source]:
    """The source of an input socket inside the group nodes `groups`, outermost first; `None` where there is nothing."""
    while True:
        link = _live_link(socket)
        if link is None:
            return Source(socket, groups)
        node, out = link.from_node, link.from_socket
        if node.bl_idname == "NodeReroute":
            socket = node.inputs[0]
        elif node.mute:
            inner = next((i for i in node.internal_links if i.to_socket == out), None)
            if inner is None:
                return None
            socket = inner.from_socket
        elif node.bl_idname == "NodeGroupInput":
            if not groups:
                return None
            socket = _by_identifier(groups[-1].inputs, out.identifier)
            groups = groups[:-1]
        elif node.bl_idname == "ShaderNodeGroup":
            end = _group_output(node.node_tree) if node.node_tree else None
            socket = _by_identifier(end.inputs, out.identifier) if end else None
            groups = (*groups, node)
        else:
            return Source(out, groups, node)
        if socket is None:
            return None


def output_node(tree, kinds=("ShaderNodeOutputMaterial", "ShaderNodeOutputWorld", "ShaderNodeOutputLight")):
    """The output node of a tree that Cycles would take."""
    found = [n for n in tree.nodes if n.bl_idname in kinds and n.target in ("ALL", "CYCLES")]
    found.sort(key=lambda n: (n.target != "CYCLES", not n.is_active_output))
    return found[0] if found else None


@dataclass
class Here:
    """A node, the groups around it, and the reader that asks it."""

    reader: Any
    node: Any
    groups: tuple = field(default=())

    def socket(self, key):
        """An input by identifier, else by name; of several of one name the one in use."""
        found = _by_identifier(self.node.inputs, key)
        if found is None:
            named = [s for s in self.node.inputs if s.name == key]
            found = next((s for s in named if s.enabled), named[0] if named else None)
        return found

    def source(self, key) -> Optional[Source]:
        socket = self.socket(key)
        return None if socket is None else source(socket, self.groups)

    def is_linked(self, key) -> bool:
        """True if another node feeds the input."""
        found = self.source(key)
        return found is not None and found.is_linked

    def number(self, key, default=0.0):
        """The value of an input as a number, or a field of numbers."""
        return self.reader.number(self, key, default)

    def colour(self, key, default=(0.0, 0.0, 0.0)):
        """The value of an input as three numbers, or a field of colours."""
        return self.reader.colour(self, key, default)

    def constant(self, key, default=0.0) -> float:
        """The value of an input as one number for the whole surface; what varies is told and replaced by its middle."""
        return self.reader.constant(self, key, default)

    def tell(self, text: str):
        """Reports what is approximated or left out at this node."""
        self.reader.tell(self.node, text)
