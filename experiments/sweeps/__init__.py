"""Sweeps: one experiment at many points, on many processes or machines, kept in one store that can be resumed."""

from ._design import Design as Design
from ._executors import cluster as cluster
from ._executors import local as local
from ._meter import meter as meter
from ._plan import Sweep as Sweep
from ._plan import plan as plan
from ._sweep import failures as failures
from ._sweep import find_finished as find_finished
from ._sweep import run as run
