"""LibEMG with NumPy, SciPy and scikit-learn alone.

`import libemg` also loads its windows, games, drivers of armbands and downloads of data sets, and with them packages of
200 MB to download that neither its classifier nor its online stream calls. Those that are not installed have a stand-in
here: its parts can be named, added to a number and inherited from, as happens when LibEMG's modules load, but not called.
"""

import importlib.abc
import importlib.machinery
import multiprocessing
import sys
import types

PACKAGES = """PIL bleak crc cv2 dearpygui h5py librosa matplotlib mindrove onedrivedownloader pandas pygame pywt serial
sifi_bridge_py websockets wfdb""".split()


class Part(type):
    def __getattr__(cls, name):
        return part(name)

    def __add__(cls, _):
        return cls

    def __call__(cls, *_, **__):
        raise ImportError(f"{cls.__name__} is of a package that is not installed")


def part(name):
    if name.startswith("__"):
        raise AttributeError(name)
    return Part(name, (), {})


class StandIns(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    def find_spec(self, name, path, target=None):
        if name.split(".")[0] in PACKAGES:
            return importlib.machinery.ModuleSpec(name, self, is_package=True)

    def create_module(self, spec):
        module = types.ModuleType(spec.name)
        module.__getattr__ = part
        return module

    def exec_module(self, module):
        """The module is empty."""


def prepare():
    """Behind every other way to find a package: one that is installed is the real one."""
    if not any(isinstance(finder, StandIns) for finder in sys.meta_path):
        sys.meta_path.append(StandIns())
        # A process of LibEMG must know the stand-ins too.
        multiprocessing.set_start_method("fork", force=True)
