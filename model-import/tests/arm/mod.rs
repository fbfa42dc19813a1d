//! A good robot, which tests change.

/// What a link weighs.
pub(crate) const BOX: &str = r#"<inertial><mass value="1"/>
    <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>"#;

/// A trunk and an arm of two joints; each test changes one thing.
pub(crate) fn arm() -> String {
    format!(
        r#"<?xml version="1.0"?>
<robot name="arm">
  <link name="trunk">{BOX}</link>
  <joint name="shoulder" type="revolute">
    <parent link="trunk"/><child link="upper"/>
    <origin xyz="0 0 0.1" rpy="0 0 0"/>
    <axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="5" velocity="2"/>
  </joint>
  <link name="upper">{BOX}</link>
  <joint name="elbow" type="continuous">
    <parent link="upper"/><child link="fore"/>
    <axis xyz="0 0 1"/>
  </joint>
  <link name="fore">{BOX}</link>
</robot>"#
    )
}
