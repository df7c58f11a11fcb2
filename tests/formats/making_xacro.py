"""A small package of xacro files: an arm of blocks, the sizes of which come from an argument and a YAML file."""

from pathlib import Path

NAMESPACE = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'

MAIN = f"""<robot name="arm" {NAMESPACE}>
<xacro:arg name="size" default="0.2"/>
<xacro:include filename="$(find arm_description)/urdf/parts.xacro"/>
<xacro:property name="sizes" value="${{xacro.load_yaml('$(find arm_description)/urdf/sizes.yaml')}}"/>
<xacro:block name="base" size="$(arg size)"/>
<xacro:block name="upper" size="${{sizes.upper / 2}}"/>
<joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/>
<origin xyz="0 0 ${{2 * sizes.upper}}"/><limit lower="-1" upper="1"/></joint>
</robot>
"""

PARTS = f"""<robot {NAMESPACE}><xacro:macro name="block" params="name size">
<link name="${{name}}"><collision><geometry>
<box size="${{size}} ${{size}} ${{size}}"/></geometry></collision></link>
</xacro:macro></robot>
"""

SIZES = "upper: 0.4\n"


def write_package(folder: Path, main: str = MAIN, parts: str = PARTS) -> Path:
    """The main file of a package `arm_description`, which lies in a folder of another name."""
    package = folder / "arm"
    (package / "urdf").mkdir(parents=True, exist_ok=True)
    (package / "package.xml").write_text("<package><name>arm_description</name></package>")
    (package / "urdf" / "parts.xacro").write_text(parts)
    (package / "urdf" / "sizes.yaml").write_text(SIZES)
    path = package / "urdf" / "arm.urdf.xacro"
    path.write_text(main)
    return path
