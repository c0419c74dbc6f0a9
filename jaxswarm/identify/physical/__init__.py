"""Which parameters a rigid body can have, the nearest such set, and its export."""
