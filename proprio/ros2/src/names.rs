//! Names of topics and types of ROS 2 on the wire of DDS.

/// Name of a topic: `rt/joint_states` for `/joint_states`.
pub fn topic(name: &str) -> String {
    format!("rt{name}")
}

/// Name of a type: `sensor_msgs::msg::dds_::JointState_` for `sensor_msgs/msg/JointState`.
pub fn type_name(schema: &str) -> String {
    let mut parts: Vec<&str> = schema.split('/').collect();
    let message = parts.pop().unwrap_or_default();
    format!("{}::dds_::{message}_", parts.join("::"))
}

#[cfg(test)]
mod tests {
    use super::{topic, type_name};

    #[test]
    fn names_are_those_of_ros_2_on_the_wire() {
        assert_eq!(topic("/joint_states"), "rt/joint_states");
        assert_eq!(topic("/proprio/shape"), "rt/proprio/shape");
        assert_eq!(type_name("sensor_msgs/msg/JointState"), "sensor_msgs::msg::dds_::JointState_");
    }
}
