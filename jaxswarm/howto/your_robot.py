"""Your robot.

``--robot`` takes a built-in name, a URDF, an SDF, an MJCF file (``pip install 'jaxswarm[mjcf]'``) or a TOML
file with joints or a DH table. Kinematics suffice: masses are what an identification finds. Where the file
has masses, they serve as ``--prior``, for torque limits of a planned motion and for checks of units.

Look first: ``jaxswarm robots show arm.urdf --out arm.png`` prints joints, axes, limits and masses, says what
of the file was skipped, and draws the skeleton. Compare an axis and an offset with the arm before you log.

A DH table is six lines of TOML, angles in rad; ``joints = ["a", "b"]`` in it names them as the logs do:

>>> import tempfile
>>> from pathlib import Path
>>> import jaxswarm
>>> path = Path(tempfile.mkdtemp()) / "arm.toml"
>>> table = 'convention = "modified", alpha = [0, 1.5708], a = [0, 0.3], d = [0.2, 0]'
>>> _ = path.write_text("dh = { " + table + " }")
>>> jaxswarm.load_robot(str(path)).joints
('joint1', 'joint2')

Joints that no log has are held still: ``--lock gripper=0.02,rail`` at a position, or ``--joints a,b,c`` for
the chain of interest; what is locked is lumped into the link that carries it. Joints that mimic another one
are locked and told. A tool is ``--tool MASS,X,Y,Z`` in the frame of the last link, an arm on a wall has
``--gravity X,Y,Z`` in base axes, and its log tells where that is wrong. A xacro template is
expanded first: ``xacro arm.urdf.xacro > arm.urdf``.

An arm that measures currents needs its drive gains in N m per ampere, ``drive_gain = [14.9, 13.3]`` in the
TOML file; a scale that is wrong there scales every parameter of the joint, and no log can tell.
"""
