"""A region of trust that does not take rounding for a failed step."""

import equinox as eqx
import jax.numpy as jnp
import optimistix as optx

ROUNDING = 16.0
"""Changes of the cost below this many units in its last place say nothing."""


class RoundingTrustRegion(optx.AbstractSearch):
    """The classical region of trust, which also accepts a step whose gain is lost in the rounding of the cost.

    Close to the solution a step is still worth taking when it changes a cost of order one by less than the cost's
    last place. Whether the cost then seems to fall or to rise is chance, and a step that is refused shrinks the
    region: the solver would crawl.
    """

    classical: optx.ClassicalTrustRegion = eqx.field(default_factory=optx.ClassicalTrustRegion)

    def init(self, y, f_info_struct):
        return self.classical.init(y, f_info_struct)

    def step(self, first_step, y, y_eval, f_info, f_eval_info, state):
        size, accept, result, next_state = self.classical.step(
            first_step, y, y_eval, f_info, f_eval_info, state
        )
        cost = f_info.as_min()
        change = jnp.abs(f_eval_info.as_min() - cost)
        unmoved = ~accept & (change <= ROUNDING * jnp.finfo(cost.dtype).eps * jnp.abs(cost))
        size = jnp.where(unmoved, state.step_size, size)
        return size, accept | unmoved, result, eqx.tree_at(lambda s: s.step_size, next_state, size)


def forgiving(solver: optx.AbstractGaussNewton) -> optx.AbstractGaussNewton:
    """The same solver with such a region of trust."""
    return eqx.tree_at(lambda s: s.search, solver, RoundingTrustRegion())
