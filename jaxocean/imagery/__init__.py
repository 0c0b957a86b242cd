"""Pixels: tone mapping, white balance, the sRGB transfer function, and how far two images are apart."""

from ._measures import largest_error as largest_error
from ._measures import mean_absolute_error as mean_absolute_error
from ._measures import mean_square_error as mean_square_error
from ._measures import psnr as psnr
from ._measures import structural_similarity as structural_similarity
from ._srgb import decode_srgb as decode_srgb
from ._srgb import encode_srgb as encode_srgb
from ._srgb import from_bytes as from_bytes
from ._srgb import to_bytes as to_bytes
from ._tone import AbstractTone as AbstractTone
from ._tone import Bruneton as Bruneton
from ._tone import Exposure as Exposure
from ._tone import Filmic as Filmic
from ._white_balance import white_balance as white_balance
