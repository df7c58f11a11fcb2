"""A cart on a rail, as the text of a file: the least robot that moves."""

URDF = """<robot name="cart"><link name="ground"/>
  <link name="slider"><collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>
  <joint name="rail" type="prismatic"><parent link="ground"/><child link="slider"/>
    <axis xyz="1 0 0"/><limit lower="-5" upper="5" effort="9" velocity="9"/></joint></robot>"""
