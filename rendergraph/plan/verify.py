"""stub for the first minutes"""
from rendergraph.plan.plan import Plan
def verify(plan: Plan) -> tuple[str, ...]:
    return ()
