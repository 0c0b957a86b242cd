"""Light that the sea's surface reflects: Fresnel, slopes, masking, sun and sky."""

from ._facing import smith_lambda as smith_lambda
from ._fresnel import AbstractFresnel as AbstractFresnel
from ._fresnel import ExactFresnel as ExactFresnel
from ._fresnel import SchlickFresnel as SchlickFresnel
from ._fresnel import fresnel as fresnel
from ._fresnel import schlick as schlick
from ._masking import AbstractMasking as AbstractMasking
from ._masking import AzimuthCorrelatedMasking as AzimuthCorrelatedMasking
from ._masking import HeightCorrelatedMasking as HeightCorrelatedMasking
from ._masking import IndependentMasking as IndependentMasking
from ._masking import masking as masking
from ._mean_fresnel import bruneton_mean_fresnel as bruneton_mean_fresnel
from ._mean_fresnel import mean_fresnel as mean_fresnel
from ._sky_reflection import AbstractSkyReflection as AbstractSkyReflection
from ._sky_reflection import BrunetonReflection as BrunetonReflection
from ._sky_reflection import FacetReflection as FacetReflection
from ._sky_reflection import LobeReflection as LobeReflection
from ._sky_reflection import SkyReflection as SkyReflection
from ._slopes import directional_variance as directional_variance
from ._slopes import slope_density as slope_density
from ._sun import sun_glitter as sun_glitter
from ._visible_slopes import AbstractVisibleSlopes as AbstractVisibleSlopes
from ._visible_slopes import SlopeQuadrature as SlopeQuadrature
from ._visible_slopes import ThreeSlopes as ThreeSlopes
