"""From a picture back to the sea."""

from ._descent import PictureStep as PictureStep
from ._fit_photograph import PhotographFit as PhotographFit
from ._fit_photograph import fit_photograph as fit_photograph
from ._fit_picture import PictureFit as PictureFit
from ._fit_picture import fit_picture as fit_picture
from ._horizon import Horizon as Horizon
from ._horizon import find_horizon as find_horizon
from ._image_statistics import ImageStatistics as ImageStatistics
from ._photograph import Photograph as Photograph
from ._picture_target import PictureTarget as PictureTarget
from ._scene_model import SceneModel as SceneModel
from ._summaries import Lesson as Lesson
from ._synthetic_likelihood import DRAWN as DRAWN
from ._teach import teach as teach
from ._uncertain_sea import TiltedSpectrum as TiltedSpectrum
from ._uncertain_sea import UncertainSea as UncertainSea
from ._waves import View as View
from ._waves import WavesFit as WavesFit
from ._waves import recover_waves as recover_waves
