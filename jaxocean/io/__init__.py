"""Files in and out: measured spectra, pictures, panoramas."""

from ._dataset import SpectrumRecords as SpectrumRecords
from ._dataset import WindOrigin as WindOrigin
from ._dataset import spectrum_from_dataset as spectrum_from_dataset
from ._dataset import wind_from_dataset as wind_from_dataset
from ._dataset import wind_origin as wind_origin
from ._exr import layer as layer
from ._exr import read_exr as read_exr
from ._exr import write_exr as write_exr
from ._images import read_image as read_image
from ._images import read_panorama as read_panorama
from ._images import write_png as write_png
from ._mesh_file import write_mesh as write_mesh
from ._negative import AbstractNegativeCells as AbstractNegativeCells
from ._negative import Clip as Clip
from ._negative import ClipAndRenormalise as ClipAndRenormalise
from ._negative import MaximumEntropy as MaximumEntropy
from ._read import Kind as Kind
from ._read import open_spectra as open_spectra
from ._read import read_spectrum as read_spectrum
from ._sequences import write_gif as write_gif
from ._sequences import write_mp4 as write_mp4
from ._ships import ShipRecords as ShipRecords
from ._ships import read_ship_records as read_ship_records
from ._write import dataset_from_spectrum as dataset_from_spectrum
from ._write import write_spectrum as write_spectrum
