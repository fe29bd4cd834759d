//! Schemas of the messages, those of ROS 2 and those of proprio, each with the schemas that it contains.

/// Name and definition of a message of ROS 2, and the definitions that it contains.
#[derive(Debug)]
pub struct Schema {
    /// Full name, such as `sensor_msgs/msg/JointState`.
    pub name: &'static str,
    /// Text of its `.msg` file.
    pub definition: &'static str,
    /// Names, such as `std_msgs/Header`, and definitions of the messages that it contains, at any depth.
    pub needs: &'static [(&'static str, &'static str)],
}

/// Name and definition of `builtin_interfaces/Time`.
pub const TIME: (&str, &str) = ("builtin_interfaces/Time", include_str!("definitions/Time.msg"));
/// Name and definition of `std_msgs/Header`, which contains [`TIME`].
pub const HEADER: (&str, &str) = ("std_msgs/Header", include_str!("definitions/Header.msg"));

/// Name and definition of `geometry_msgs/Pose`, which contains [`POINT`] and [`QUATERNION`].
pub const POSE: (&str, &str) = ("geometry_msgs/Pose", include_str!("definitions/Pose.msg"));
/// Name and definition of `geometry_msgs/Point`.
pub const POINT: (&str, &str) = ("geometry_msgs/Point", include_str!("definitions/Point.msg"));
/// Name and definition of `geometry_msgs/Quaternion`.
pub const QUATERNION: (&str, &str) = ("geometry_msgs/Quaternion", include_str!("definitions/Quaternion.msg"));

pub(super) static JOINT_STATE: Schema = Schema {
    name: "sensor_msgs/msg/JointState",
    definition: include_str!("definitions/JointState.msg"),
    needs: &[HEADER, TIME],
};

pub(super) static POSE_ARRAY: Schema = Schema {
    name: "geometry_msgs/msg/PoseArray",
    definition: include_str!("definitions/PoseArray.msg"),
    needs: &[HEADER, TIME, POSE, POINT, QUATERNION],
};

pub(super) static DIAGNOSTIC_ARRAY: Schema = Schema {
    name: "diagnostic_msgs/msg/DiagnosticArray",
    definition: include_str!("definitions/DiagnosticArray.msg"),
    needs: &[
        HEADER,
        TIME,
        ("diagnostic_msgs/DiagnosticStatus", include_str!("definitions/DiagnosticStatus.msg")),
        ("diagnostic_msgs/KeyValue", include_str!("definitions/KeyValue.msg")),
    ],
};

pub(super) static SAMPLE: Schema = Schema {
    name: "proprio_msgs/msg/Sample",
    definition: include_str!("definitions/Sample.msg"),
    needs: &[HEADER, TIME],
};

pub(super) static UNCERTAINTY: Schema = Schema {
    name: "proprio_msgs/msg/Uncertainty",
    definition: include_str!("definitions/Uncertainty.msg"),
    needs: &[HEADER, TIME],
};

pub(super) static CONTACT: Schema = Schema {
    name: "proprio_msgs/msg/Contact",
    definition: include_str!("definitions/Contact.msg"),
    needs: &[HEADER, TIME],
};

pub(super) static TRUTH: Schema = Schema {
    name: "proprio_msgs/msg/Truth",
    definition: include_str!("definitions/Truth.msg"),
    needs: &[HEADER, TIME],
};

pub(super) static SET_POINTS: Schema = Schema {
    name: "proprio_msgs/msg/SetPoints",
    definition: include_str!("definitions/SetPoints.msg"),
    needs: &[HEADER, TIME],
};

pub(super) static STRING: Schema =
    Schema { name: "std_msgs/msg/String", definition: include_str!("definitions/String.msg"), needs: &[] };

pub(super) static UINT8_MULTI_ARRAY: Schema = Schema {
    name: "std_msgs/msg/UInt8MultiArray",
    definition: include_str!("definitions/UInt8MultiArray.msg"),
    needs: &[
        ("std_msgs/MultiArrayLayout", include_str!("definitions/MultiArrayLayout.msg")),
        ("std_msgs/MultiArrayDimension", include_str!("definitions/MultiArrayDimension.msg")),
    ],
};

impl Schema {
    /// The definition and all that it contains, in MCAP's encoding `ros2msg`.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = self.definition.to_owned();
        for (name, definition) in self.needs {
            text.extend([&"=".repeat(80), "\nMSG: ", name, "\n", definition]);
        }
        text
    }
}
