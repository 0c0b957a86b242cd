"""What a footprint sees: means and second moments of slopes and strain, filtered from any surface."""

from ._boxes import box_means as box_means
from ._compressed import CompressedMoments as CompressedMoments
from ._footprint import Footprint as Footprint
from ._mean_pyramid import MeanPyramid as MeanPyramid
from ._moment_pyramid import MomentPyramid as MomentPyramid
from ._moments import Moments as Moments
from ._moments import pair_products as pair_products
from ._moments import symmetric_matrix as symmetric_matrix
from ._refine import refine as refine
from ._resample import resample as resample
from ._sampled import sampled_moments as sampled_moments
