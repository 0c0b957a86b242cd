"""Pictures of the sea: a camera, what each of its pixels sees, and the light that comes from there."""

from ._camera import Camera as Camera
from ._camera import check_above as check_above
from ._edges import Edges as Edges
from ._footprint import SurfaceMoments as SurfaceMoments
from ._gradient import value_and_gradient as value_and_gradient
from ._map_visible import Raster as Raster
from ._map_visible import map_visible as map_visible
from ._map_visible import visible_points as visible_points
from ._patch_mesh import patch_mesh as patch_mesh
from ._planet import EARTH_CURVATURE as EARTH_CURVATURE
from ._rays import Rays as Rays
from ._render import Layers as Layers
from ._render import render as render
from ._render import render_layers as render_layers
from ._scene_light import seen_coverage as seen_coverage
from ._visible import Visible as Visible
