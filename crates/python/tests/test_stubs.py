"""Every public name says what it is and what it takes; the stubs of the native part have its names."""

import ast
import inspect
import os

import numpy as np
import pytest

import steradian as st

STUB = os.path.join(os.path.dirname(st.__file__), "_steradian.pyi")
TREE = ast.parse(open(STUB, encoding="utf-8").read())
NATIVE = st._steradian
SHOWN = {"__getitem__", "__len__", "__array__", "__enter__", "__exit__", "_repr_html_", "_repr_png_", "__new__"}


def is_public(name):
    return not name.startswith("_")


def names_of(body):
    """Names that a part of the stub defines, with their nodes; and those that a text follows."""
    found, told = {}, set()
    for node, after in zip(body, [*body[1:], None]):
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            found[node.name] = node
            if ast.get_docstring(node):
                told.add(node.name)
        elif isinstance(node, ast.AnnAssign):
            found[node.target.id] = node
            if isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant):
                told.add(node.target.id)
    return found, told


def test_the_stub_has_the_names_of_the_native_part():
    found, told = names_of(TREE.body)
    assert set(found) == {name for name in vars(NATIVE) if is_public(name) or name == "__version__"}
    assert set(found) == told
    for name, node in found.items():
        if isinstance(node, ast.ClassDef) and name != "SceneError":
            members, told = names_of(node.body)
            there = {m for m in vars(getattr(NATIVE, name)) if is_public(m)}
            assert {m for m in members if is_public(m)} == there, name
            assert {m for m in members if not is_public(m)} <= SHOWN
            assert there <= told, f"{name}: {there - told} say nothing"


def functions():
    for node in TREE.body:
        if isinstance(node, ast.FunctionDef):
            yield node.name, node, getattr(NATIVE, node.name)
        elif isinstance(node, ast.ClassDef):
            for part in node.body:
                if isinstance(part, ast.FunctionDef) and not part.name.startswith("__"):
                    yield f"{node.name}.{part.name}", part, getattr(getattr(NATIVE, node.name), part.name)


@pytest.mark.parametrize(("name", "node", "function"), [pytest.param(*f, id=f[0]) for f in functions()])
def test_functions_have_the_parameters_that_the_stub_says(name, node, function):
    arguments = [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs]
    assert node.returns is not None and all(a.annotation for a in arguments if a.arg != "self"), name
    if callable(function):
        there = inspect.signature(function).parameters
        assert [a.arg for a in arguments] == list(there), name
        optional = [p.default is not inspect.Parameter.empty for p in there.values()]
        positional = node.args.posonlyargs + node.args.args
        said = [False] * (len(positional) - len(node.args.defaults)) + [True] * len(node.args.defaults)
        assert [*said, *(d is not None for d in node.args.kw_defaults)] == optional, name
        kinds = [p.kind is inspect.Parameter.KEYWORD_ONLY for p in there.values()]
        assert kinds == [False] * len(positional) + [True] * len(node.args.kwonlyargs), name
    if is_public(name.rpartition(".")[2]):
        assert function.__doc__, f"{name} says nothing at run time"


def members():
    for name in st.__all__:
        value = getattr(st, name)
        yield name, value
        if inspect.isclass(value) and value.__module__ != "builtins":
            yield from ((f"{name}.{m}", v) for m, v in vars(value).items() if is_public(m))


@pytest.mark.parametrize(("name", "value"), [pytest.param(*m, id=m[0]) for m in members()])
def test_public_names_say_what_they_are_and_take(name, value):
    if isinstance(value, property):
        assert value.__doc__ and inspect.signature(value.fget).return_annotation is not inspect.Signature.empty
    elif inspect.isclass(value) or inspect.isdatadescriptor(value):
        assert value.__doc__, f"{name} says nothing"
    elif inspect.isfunction(value):
        signature = inspect.signature(value)
        assert value.__doc__ and signature.return_annotation is not inspect.Signature.empty
        untyped = [p.name for p in signature.parameters.values() if p.annotation is inspect.Parameter.empty and p.name != "self"]
        assert not untyped, f"{name}: {untyped} have no types"
    elif callable(value):
        assert value.__doc__, f"{name} says nothing"


def test_the_package_is_typed():
    assert os.path.exists(os.path.join(os.path.dirname(st.__file__), "py.typed"))
    assert st.__doc__ and sorted(st.__all__, key=str.lower) and all(hasattr(st, name) for name in st.__all__)
    # What fields of hits are, in the source: each with its type.
    assert all(field.type for field in st.Hits.__dataclass_fields__.values())
    assert isinstance(st.scene({"shapes": [{"shape": "sphere"}]}).trace([0, 0, 3], [0, 0, -1]).t, np.ndarray)
