"""Directional spreading: how the energy of one wavenumber is distributed over directions."""

from ._cosine import Cosine2s as Cosine2s
from ._cosine import Hasselmann1980 as Hasselmann1980
from ._cosine import Mitsuyasu as Mitsuyasu
from ._donelan_banner import DonelanBanner as DonelanBanner
from ._elfouhaily import ElfouhailySpreading as ElfouhailySpreading
from ._elfouhaily import capillary_gravity_speed as capillary_gravity_speed
from ._spreading import AbstractSpreading as AbstractSpreading
from ._spreading import WavePeak as WavePeak
