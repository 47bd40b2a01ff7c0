"""Runs code of other projects unchanged, without the big packages that it imports.

`genuine` makes packages of a clone importable, and puts stand-ins in the place of packages that reading files does
not need: torch, transformers, simulators. Nothing in the clone is changed.
"""

import builtins
import contextlib
import functools
import importlib.abc
import importlib.machinery
import importlib.util
import sys
import types

import numpy as np
from PIL import Image


class Anything:
    """A stand-in: it has every attribute, can be called, and can be a base class."""

    def __init__(self, *args, **kwargs):
        pass

    def __call__(self, *args, **kwargs):
        # As a decorator it hands the function back.
        return args[0] if len(args) == 1 and not kwargs and callable(args[0]) else Anything()

    def __getattr__(self, name):
        if name.startswith("__"):
            raise AttributeError(name)
        return Anything()

    def __getitem__(self, key):
        return Anything()

    def __mro_entries__(self, bases):
        return ()

    def __or__(self, other):
        return Anything()

    __ror__ = __or__


class Tensor(np.ndarray):
    """As much of torch's tensor as the loaders need."""

    def __new__(cls, values, **kwargs):
        return np.asarray(values).view(cls)

    def float(self):
        return self.astype(np.float32)

    def unsqueeze(self, axis):
        return np.expand_dims(self, axis)

    def clone(self):
        return self.copy()

    def ne(self, other):
        return self != other

    def numel(self):
        return self.size


# What the loaders do with torch when they read a sample.
TORCH = {
    "torch.Tensor": Tensor,
    "torch.tensor": Tensor,
    "torch.as_tensor": Tensor,
    "torch.from_numpy": Tensor,
    "torch.LongTensor": Tensor,
    "torch.BoolTensor": lambda values: Tensor(np.asarray(values, bool)),
    "torch.long": np.int64,
    "torch.where": lambda condition: [Tensor(found) for found in np.where(condition)],
    "torch.stack": lambda parts, dim=0: Tensor(np.stack(parts, dim)),
    "torch.cat": lambda parts, dim=0: Tensor(np.concatenate(parts, dim)),
}


class Pictures:
    """In the place of PIL's module `Image`: it notes which files are opened, and keeps the last ones."""

    new, fromarray = staticmethod(Image.new), staticmethod(Image.fromarray)
    NEAREST, Image = Image.NEAREST, Image.Image

    def __init__(self):
        self.names = set()

    def open(self, name):
        self.names.add(str(name))
        return _decoded(str(name))


@functools.lru_cache(maxsize=400)
def _decoded(name):
    image = Image.open(name)
    image.load()
    return image


class _Module(types.ModuleType):
    def __getattr__(self, name):
        if name.startswith("__"):
            raise AttributeError(name)
        return Anything()


class _Finder(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Finds a stand-in for each module under the given names."""

    def __init__(self, names, values):
        self.names, self.values = names, values

    def find_spec(self, name, path=None, target=None):
        if any(name == n or name.startswith(n + ".") for n in self.names):
            return importlib.machinery.ModuleSpec(name, self, is_package=True)
        return None

    def create_module(self, spec):
        return _Module(spec.name)

    def exec_module(self, module):
        module.__all__ = []
        for path, value in self.values.items():
            owner, _, name = path.rpartition(".")
            if owner == module.__name__:
                setattr(module, name, value)


@contextlib.contextmanager
def genuine(packages, absent, values=None):
    """For the time of a `with` block:

    packages  name -> folder in a clone: importable, without running its `__init__.py`
    absent    names that get a stand-in
    values    "module.name" -> what that name of a stand-in is, beside TORCH
    """
    roots = {n.split(".")[0] for n in [*absent, *packages]}
    ours = lambda name: name.split(".")[0] in roots
    saved = {n: m for n, m in sys.modules.items() if ours(n)}
    printing = builtins.print
    for name in saved:
        del sys.modules[name]
    for name, folder in packages.items():
        if not folder.is_dir():
            raise FileNotFoundError(folder)
        module = types.ModuleType(name)
        module.__path__ = [str(folder)]
        sys.modules[name] = module
    finder = _Finder(absent, {**TORCH, **(values or {})})
    sys.meta_path.insert(0, finder)
    try:
        yield
    finally:
        sys.meta_path.remove(finder)
        for name in [n for n in sys.modules if ours(n)]:
            del sys.modules[name]
        sys.modules.update(saved)
        builtins.print = printing  # InternNav's NavDP loader replaces it


def load(file):
    """Runs a single file of a clone as a module."""
    spec = importlib.util.spec_from_file_location(file.stem, file)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
