//! Schemas of the messages, those of ROS 2 and those of proprio, each with the schemas that it contains.

/// Name and definition of a message, and the definitions that it contains.
#[derive(Debug)]
pub struct Schema {
    pub name: &'static str,
    definition: &'static str,
    needs: &'static [(&'static str, &'static str)],
}

const TIME: (&str, &str) = ("builtin_interfaces/Time", include_str!("definitions/Time.msg"));
const HEADER: (&str, &str) = ("std_msgs/Header", include_str!("definitions/Header.msg"));

pub const JOINT_STATE: Schema = Schema {
    name: "sensor_msgs/msg/JointState",
    definition: include_str!("definitions/JointState.msg"),
    needs: &[HEADER, TIME],
};

pub const POSE_ARRAY: Schema = Schema {
    name: "geometry_msgs/msg/PoseArray",
    definition: include_str!("definitions/PoseArray.msg"),
    needs: &[
        HEADER,
        TIME,
        ("geometry_msgs/Pose", include_str!("definitions/Pose.msg")),
        ("geometry_msgs/Point", include_str!("definitions/Point.msg")),
        ("geometry_msgs/Quaternion", include_str!("definitions/Quaternion.msg")),
    ],
};

pub const DIAGNOSTIC_ARRAY: Schema = Schema {
    name: "diagnostic_msgs/msg/DiagnosticArray",
    definition: include_str!("definitions/DiagnosticArray.msg"),
    needs: &[
        HEADER,
        TIME,
        ("diagnostic_msgs/DiagnosticStatus", include_str!("definitions/DiagnosticStatus.msg")),
        ("diagnostic_msgs/KeyValue", include_str!("definitions/KeyValue.msg")),
    ],
};

pub const SAMPLE: Schema = Schema {
    name: "proprio_msgs/msg/Sample",
    definition: include_str!("definitions/Sample.msg"),
    needs: &[HEADER, TIME],
};

pub const UNCERTAINTY: Schema = Schema {
    name: "proprio_msgs/msg/Uncertainty",
    definition: include_str!("definitions/Uncertainty.msg"),
    needs: &[HEADER, TIME],
};

pub const CONTACT: Schema = Schema {
    name: "proprio_msgs/msg/Contact",
    definition: include_str!("definitions/Contact.msg"),
    needs: &[HEADER, TIME],
};

pub const TRUTH: Schema = Schema {
    name: "proprio_msgs/msg/Truth",
    definition: include_str!("definitions/Truth.msg"),
    needs: &[HEADER, TIME],
};

pub const SET_POINTS: Schema = Schema {
    name: "proprio_msgs/msg/SetPoints",
    definition: include_str!("definitions/SetPoints.msg"),
    needs: &[HEADER, TIME],
};

pub const STRING: Schema =
    Schema { name: "std_msgs/msg/String", definition: include_str!("definitions/String.msg"), needs: &[] };

impl Schema {
    /// The definition and all that it contains, in MCAP's encoding `ros2msg`.
    pub fn text(&self) -> String {
        let mut text = self.definition.to_owned();
        for (name, definition) in self.needs {
            text.extend([&"=".repeat(80), "\nMSG: ", name, "\n", definition]);
        }
        text
    }
}
