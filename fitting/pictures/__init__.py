"""From a picture back to the sea."""

from ._descent import PictureStep as PictureStep
from ._fit_picture import PictureFit as PictureFit
from ._fit_picture import fit_picture as fit_picture
from ._horizon import Horizon as Horizon
from ._horizon import find_horizon as find_horizon
from ._picture_target import PictureTarget as PictureTarget
from ._scene_model import SceneModel as SceneModel
from ._waves import View as View
from ._waves import WavesFit as WavesFit
from ._waves import recover_waves as recover_waves
